//! `cargo xtask bench --instructions`: what the hottest kernels cost, counted instead of timed.
//!
//! Valgrind's tool callgrind counts the instructions of a function, which do not depend on what else
//! the machine does. The counts per vertex stand in `xtask/instructions.txt`; a kernel that takes a
//! tenth more fails.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::{bench, root, shown, target};

/// Functions of `bench_worker.rs`, with the request that runs each.
const KERNELS: [(&str, &str); 2] = [("kernel_midpoint", "midpoint"), ("kernel_solve", "stages")];
/// Lattice points along each axis of the ball that is measured.
const SIZE: usize = 64;
/// More than this times what is written fails.
const TOLERANCE: f64 = 1.1;

/// Why nothing can be counted here, if so.
pub(crate) fn obstacle() -> Option<&'static str> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return Some("the counts are those of Linux on x86-64");
    }
    let found = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status();
    match found {
        Ok(status) if status.success() => None,
        _ => Some("valgrind is not installed (Debian, Ubuntu: valgrind)"),
    }
}

/// Counts, and compares with the limits or makes them anew.
pub(crate) fn run(accept: bool) -> Result<()> {
    if let Some(obstacle) = obstacle() {
        println!("instruction counts: skipped, {obstacle}");
        return Ok(());
    }
    let worker = bench::worker()?;
    let folder = target().join("bench");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let volume = folder.join(format!("ball{SIZE}.raw"));
    fs::write(&volume, ball()).with_context(|| format!("cannot write {}", volume.display()))?;
    let mut found = BTreeMap::new();
    for (kernel, request) in KERNELS {
        found.insert(kernel.to_owned(), count(&worker, &volume, kernel, request)?);
    }
    if accept {
        return fs::write(limits_file(), written(&found)).context("cannot write the limits");
    }
    let limits = fs::read_to_string(limits_file())
        .with_context(|| format!("cannot read {}", limits_file().display()))?;
    judge(&found, &read(&limits)?)
}

/// One byte per lattice point, 1 inside a ball off the middle.
fn ball() -> Vec<u8> {
    let squared = |i: usize, offset: f64| (i as f64 - (SIZE as f64 - 1.0) / 2.0 - offset).powi(2);
    let radius = 0.4 * SIZE as f64;
    let inside = |n: usize| {
        let [i, j, k] = [n % SIZE, n / SIZE % SIZE, n / SIZE / SIZE];
        squared(i, 0.137) + squared(j, 0.071) + squared(k, -0.093) <= radius * radius
    };
    (0..SIZE.pow(3)).map(|n| inside(n).into()).collect()
}

/// Instructions per vertex of one kernel on one thread.
fn count(worker: &Path, volume: &Path, kernel: &str, request: &str) -> Result<f64> {
    let profile = target().join("bench").join(format!("{kernel}.callgrind"));
    let dims = [SIZE.to_string(), SIZE.to_string(), SIZE.to_string()].join(",");
    let mut command = Command::new("valgrind");
    command
        .args(["--quiet", "--tool=callgrind"])
        .arg(format!("--toggle-collect=*{kernel}*"))
        .arg(format!("--callgrind-out-file={}", profile.display()))
        .arg(worker)
        .arg(volume)
        .args([dims.as_str(), "1,1,1", "default", "1"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    let mut child = command.spawn().with_context(|| format!("cannot start {}", shown(&command)))?;
    if let Some(mut input) = child.stdin.take() {
        writeln!(input, "{request}")?;
    }
    let output = child.wait_with_output()?;
    let answer = String::from_utf8_lossy(&output.stdout);
    let vertices = after(&answer, "\"vertices\":").filter(|&vertices| vertices > 0.0);
    let profile = fs::read_to_string(&profile).unwrap_or_default();
    let instructions = after(&profile, "\ntotals: ").filter(|&instructions| instructions > 0.0);
    let (Some(vertices), Some(instructions)) = (vertices, instructions) else {
        bail!("{}: {} counted nothing in {kernel}", output.status, shown(&command));
    };
    Ok(instructions / vertices)
}

/// The whole number that follows `key`.
fn after(text: &str, key: &str) -> Option<f64> {
    let (_, rest) = text.split_once(key)?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

fn judge(found: &BTreeMap<String, f64>, limits: &BTreeMap<String, f64>) -> Result<()> {
    let mut over = Vec::new();
    for (kernel, &count) in found {
        let limit = limits.get(kernel).copied().unwrap_or(0.0);
        let change = 100.0 * (count / limit - 1.0);
        let line = format!(
            "{kernel}: {count:.0} instructions per vertex, {limit:.0} written ({change:+.1} %)"
        );
        println!("{line}");
        if count > TOLERANCE * limit {
            over.push(line);
        }
    }
    if !over.is_empty() {
        bail!(
            "more than a tenth above xtask/instructions.txt: {}. Make it cheaper; or, when the work is \
             worth it or the compiler is another, run `cargo xtask bench --instructions --accept`",
            over.join("; ")
        );
    }
    Ok(())
}

fn limits_file() -> PathBuf {
    root().join("xtask/instructions.txt")
}

/// The limits as the file has them.
fn written(counts: &BTreeMap<String, f64>) -> String {
    let mut text = format!(
        "# Instructions per vertex of a ball on {SIZE}³ lattice points, one thread, default preset.\n\
         # Written by `cargo xtask bench --instructions --accept` with {}.\n",
        compiler()
    );
    for (kernel, count) in counts {
        let _ = writeln!(text, "{kernel} {count:.0}");
    }
    text
}

fn read(text: &str) -> Result<BTreeMap<String, f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    lines
        .map(|line| {
            let (kernel, count) = line.split_once(' ').unwrap_or((line, ""));
            let count = count.parse();
            Ok((kernel.to_owned(), count.with_context(|| format!("no number of {kernel}"))?))
        })
        .collect()
}

fn compiler() -> String {
    let output = Command::new("rustc").arg("--version").output();
    output.map_or_else(|_| "rustc".into(), |o| String::from_utf8_lossy(&o.stdout).trim().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(midpoint: f64) -> BTreeMap<String, f64> {
        BTreeMap::from([("kernel_midpoint".into(), midpoint)])
    }

    #[test]
    fn a_tenth_more_is_too_much() {
        assert!(judge(&counts(109.0), &counts(100.0)).is_ok());
        assert!(judge(&counts(50.0), &counts(100.0)).is_ok());
        let error = judge(&counts(111.0), &counts(100.0)).unwrap_err().to_string();
        assert!(error.contains("111") && error.contains("--accept"), "{error}");
        assert!(judge(&counts(1.0), &BTreeMap::new()).is_err(), "a kernel without a limit");
    }

    #[test]
    fn what_is_written_can_be_read() {
        assert_eq!(read(&written(&counts(123.0))).unwrap(), counts(123.0));
        assert!(read("kernel_midpoint many").is_err());
    }

    #[test]
    fn every_limit_has_its_kernel() {
        let limits = read(&fs::read_to_string(limits_file()).unwrap()).unwrap();
        let mut kernels = KERNELS.map(|(kernel, _)| kernel);
        kernels.sort_unstable();
        assert_eq!(limits.keys().map(String::as_str).collect::<Vec<_>>(), kernels);
    }

    #[test]
    fn the_ball_is_round() {
        let inside = ball().iter().map(|&byte| f64::from(byte)).sum::<f64>();
        let radius = 0.4 * SIZE as f64;
        let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        assert!((inside / volume - 1.0).abs() < 0.005, "{inside} of {volume}");
    }
}
