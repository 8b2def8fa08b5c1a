//! One vertex alone: a single step of the paper's sweeps.

use crate::error::Error;
use crate::network::Network;
use crate::optimize::bounds::{cut, intervals};
use crate::optimize::flat::flatness;
use crate::optimize::problem::{Conditions, Problem};
use crate::optimize::settings::Settings;
use crate::optimize::thin;
use crate::optimize::univariate::minimise;
use crate::surface::Surface;

/// The δ of vertex `v` that minimises the energy along its grid edge while all other vertices stay:
/// the minimum of the univariate function h of section 2.
///
/// `delta` has the δ of every vertex; weights and barrier, where the energy has any, are those of the
/// surface there. Of the settings only energy, margin and intervals matter.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range.
///
/// # Panics
/// When `delta` has not one value per vertex or there is no vertex `v`.
pub fn minimise_vertex(
    surface: &Surface,
    settings: &Settings,
    delta: &[f64],
    v: u32,
) -> Result<f64, Error> {
    assert_eq!(delta.len(), surface.vertex_count(), "one delta per vertex");
    settings.validate()?;
    let energy = settings.energy();
    let flatness = flatness(surface);
    let conditions = Conditions::new(surface, settings, &energy, &flatness);
    let network = Network::trace(surface);
    let mut problem = Problem::<f64>::new(&network, &conditions, <[f32]>::to_vec);
    problem.keep_thin_parts(|| thin::of_rods(surface));
    let [low, high] = conditions.bounds;
    let own = intervals(surface, settings, conditions.bounds)?;
    problem.narrow(&own);
    // δ from the position and the position from δ are the same reflection.
    let positions = surface.crossings().zip(delta).map(|(c, &delta)| c.from_low(delta));
    let mut x: Vec<f64> = positions.map(|x| x.clamp(low, high)).collect();
    cut(&mut x, problem.bounds.own(0));
    problem.freeze(&x);
    minimise(&problem, &mut x, v);
    Ok(surface.crossing(v).from_low(x[v as usize]))
}
