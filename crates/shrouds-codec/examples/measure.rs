//! throw-away
use std::time::Instant;
use shrouds_codec::{coder::*, topology::{*, scan::Scan, fast::Fast, dense::Dense}};
fn cpu()->f64{ let s=std::fs::read_to_string("/proc/thread-self/schedstat").unwrap(); s.split(' ').next().unwrap().parse::<f64>().unwrap()*1e-9 }
fn npy(p:&str)->([usize;3],Vec<u8>){ let b=std::fs::read(p).unwrap(); let h=u16::from_le_bytes([b[8],b[9]]) as usize; let t=String::from_utf8_lossy(&b[10..10+h]).to_string(); let i=t.find("'shape': (").unwrap()+10; let j=t[i..].find(')').unwrap()+i; let d:Vec<usize>=t[i..j].split(',').filter_map(|x|x.trim().parse().ok()).collect(); ([d[2],d[1],d[0]],b[10+h..].to_vec()) }
pub fn words(d:[usize;3],v:&[u8])->Vec<u64>{ let w=d[0].div_ceil(64); let mut o=vec![0u64;w*d[1]*d[2]]; for r in 0..d[1]*d[2]{ for x in 0..d[0]{ if v[r*d[0]+x]!=0{ o[r*w+x/64]|=1<<(x%64); } } } o }
fn verts(d:[usize;3],v:&[u8])->usize{ let mut c=0; let f=|i:usize|v[i]!=0; for z in 0..d[2]{for y in 0..d[1]{for x in 0..d[0]{ let i=x+d[0]*(y+d[1]*z); if x+1<d[0]&&f(i)!=f(i+1){c+=1} if y+1<d[1]&&f(i)!=f(i+d[0]){c+=1} if z+1<d[2]&&f(i)!=f(i+d[0]*d[1]){c+=1} }}} c }
struct Counted<M>(M,usize); impl<M:Model> Model for Counted<M>{ const ROWS:usize=M::ROWS; #[inline(always)] fn predict(&mut self,w:&Window)->u16{ self.1+=1; self.0.predict(w) } #[inline(always)] fn update(&mut self,b:bool){ self.0.update(b) } }
fn run<M:Model>(name:&str,d:[usize;3],src:&[u64],v:usize,mk:&dyn Fn()->M){ let l=src.len()/d[2]; let mut best=[f64::MAX;2]; let mut out=vec![]; let mut ev=0;
 let reps=if src.len()<2_000_000 {3} else {2};
 for _ in 0..reps{ let mut w=src.to_vec(); let mut m=Counted(mk(),0); let mut s=Scan::new([d[0],d[1]]); let mut e=Encoder::new(); let t=cpu(); for c in w.chunks_mut(l){ s.layer(&mut e,&mut m,c); } out=e.finish(); best[0]=best[0].min(cpu()-t); ev=m.1; assert!(w==src); }
 for _ in 0..reps{ let mut w=vec![0u64;src.len()]; let mut m=mk(); let mut s=Scan::new([d[0],d[1]]); let t=cpu(); let mut e=Decoder::new(&out); for c in w.chunks_mut(l){ s.layer(&mut e,&mut m,c); } best[1]=best[1].min(cpu()-t); assert!(w==src,"roundtrip"); }
 let n=(d[0]*d[1]*d[2]) as f64/1e6; println!("  {name:8} {:7} B {:.4} b/tri  enc {:7.1} dec {:7.1} Mvox/s  {:.3} {:.3} us/v  evals/v {:.2}",out.len(),out.len() as f64*4.0/v as f64,n/best[0],n/best[1],best[0]*1e6/v as f64,best[1]*1e6/v as f64,ev as f64/v as f64); }
fn main(){ let _=Instant::now(); let a:Vec<String>=std::env::args().skip(1).collect(); let mode=&a[0]; for p in &a[1..]{ let (d,v)=npy(p); let n=verts(d,&v); let s=words(d,&v); println!("{} {:?} {} v",p.rsplit('/').next().unwrap(),d,n); if mode.contains('f'){ run("fast",d,&s,n,&Fast::default); } if mode.contains('d'){ run("dense",d,&s,n,&Dense::default); } } }
