//! The volume that each component of a surface encloses, and how it changes with the positions.
//!
//! Lengths are in grid edges along every axis and volumes in voxels: the ratio of two volumes is the
//! same in all frames. A volume is the integral of x over the surface's projection along x.

use crate::parallel;
use crate::surface::{Components, Surface};
use crate::vector::{Vector, add, cross, length, scale, subtract};

/// The index coordinates of all vertices.
pub(super) fn places(surface: &Surface, x: &[f64]) -> Vec<Vector> {
    let mut places = vec![[0.0; 3]; x.len()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut places, ends, |k, piece| {
        let x = &x[surface.slice_vertices(k).start as usize..];
        for ((place, x), crossing) in piece.iter_mut().zip(x).zip(surface.slice_crossings(k)) {
            *place = crossing.low().map(|index| index as f64);
            place[crossing.axis()] += x;
        }
    });
    places
}

/// The volumes below these triangles, in voxels, of every component.
pub(super) fn of_triangles(
    surface: &Surface,
    components: &Components,
    triangles: &[[u32; 3]],
    x: &[f64],
) -> Vec<f64> {
    let places = places(surface, x);
    let mut below = vec![0.0; triangles.len()];
    parallel::fill(&mut below, |n| below_triangle(triangles[n].map(|v| places[v as usize])));
    let first = triangles.iter().map(|triangle| triangle[0]);
    by_component(components, first.zip(below))
}

/// A surface whose patches are fans around the mean of their corners. No choice of diagonals enters, so
/// the volume is a smooth function of the positions.
pub(super) struct Fans<'a> {
    surface: &'a Surface,
    components: &'a Components,
    /// A vertex of every patch.
    corners: Vec<u32>,
}

impl<'a> Fans<'a> {
    pub(super) fn new(surface: &'a Surface, components: &'a Components) -> Self {
        let mut corners = vec![0; surface.patch_count()];
        for_each_patch(surface, &mut corners, |patch| patch[0]);
        Self { surface, components, corners }
    }

    /// The volumes of all components.
    pub(super) fn volumes(&self, x: &[f64]) -> Vec<f64> {
        let places = places(self.surface, x);
        let mut below = vec![0.0; self.corners.len()];
        for_each_patch(self.surface, &mut below, |patch| {
            let middle = mean(patch, &places);
            fan(patch).map(|[a, b]| below_triangle([middle, places[a], places[b]])).sum()
        });
        by_component(self.components, self.corners.iter().copied().zip(below))
    }

    /// How the volumes change from here.
    pub(super) fn gradient(&self, x: &[f64]) -> Gradient {
        let surface = self.surface;
        let places = places(surface, x);
        let mut pulls = vec![[0.0; 3]; x.len()];
        let slices = surface.slice_count();
        let start = |k: usize| match k < slices {
            true => surface.slice_vertices(k).start as usize,
            false => x.len(),
        };
        // Layers with one between them share no slice.
        for odd in [0, 1] {
            let ends = (0..=slices / 2).map(|pair| start(2 * pair + 2 - odd));
            parallel::pieces(&mut pulls, ends, |pair, piece| {
                let Some(layer) = (2 * pair).checked_sub(odd) else { return };
                if layer >= surface.layer_count() {
                    return;
                }
                let first = start(layer);
                surface.for_each_patch(layer, |patch, _| {
                    add_pulls(patch, &places, |v, pull| {
                        piece[v - first] = add(piece[v - first], pull);
                    });
                });
            });
        }
        let (mut slopes, mut offsets) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let spacing = surface.grid().spacing();
        let unit = surface.grid().min_spacing();
        for (v, (pull, crossing)) in pulls.into_iter().zip(surface.crossings()).enumerate() {
            let axis = crossing.axis();
            slopes[v] = pull[axis];
            let normal = std::array::from_fn(|k| pull[k] / spacing[k]);
            let along = normal[axis].abs() * spacing[axis] / unit;
            let outwards = if crossing.inside_low() { 1.0 } else { -1.0 };
            let [least, most] = OFFSETS;
            // Where the surface has no area it has no normal either: there this is not a number.
            offsets[v] = outwards * (length(normal) / along).max(least).min(most);
        }
        Gradient { slopes, offsets }
    }
}

/// How the volumes change with the positions.
pub(super) struct Gradient {
    /// The derivative of the volume of every vertex's component by its position.
    pub(super) slopes: Vec<f64>,
    /// How every vertex moves along its grid edge when the surface moves outwards by the smallest
    /// spacing everywhere; where the surface runs along the edge, no more than `OFFSETS` allow.
    pub(super) offsets: Vec<f64>,
}

/// Between what offsets are kept.
pub(super) const OFFSETS: [f64; 2] = [0.1, 3.0];

/// What a patch adds to the derivatives of the volume by the places of its vertices. By the place of a
/// corner that is a third of the areas of the triangles around it, as vectors, and by that of the
/// middle a third of them all, of which each corner has an equal share.
fn add_pulls(patch: &[u32], places: &[Vector], mut add_pull: impl FnMut(usize, Vector)) {
    let middle = mean(patch, places);
    let area = |[a, b]: [usize; 2]| {
        scale(cross(subtract(places[a], middle), subtract(places[b], middle)), 1.0 / 6.0)
    };
    let whole = fan(patch).fold([0.0; 3], |sum, side| add(sum, area(side)));
    let share = scale(whole, 1.0 / patch.len() as f64);
    for [a, b] in fan(patch) {
        let area = area([a, b]);
        add_pull(a, add(area, share));
        add_pull(b, area);
    }
}

/// The sides of a patch.
fn fan(patch: &[u32]) -> impl Iterator<Item = [usize; 2]> + '_ {
    let next = patch.iter().cycle().skip(1);
    patch.iter().zip(next).map(|(&a, &b)| [a as usize, b as usize])
}

fn mean(patch: &[u32], places: &[Vector]) -> Vector {
    let sum = patch.iter().fold([0.0; 3], |sum, &v| add(sum, places[v as usize]));
    scale(sum, 1.0 / patch.len() as f64)
}

/// The signed volume between a triangle and the plane x = 0.
fn below_triangle([a, b, c]: [Vector; 3]) -> f64 {
    let ([_, u, v], [_, p, q]) = (subtract(b, a), subtract(c, a));
    (a[0] + b[0] + c[0]) * (u * q - v * p) / 6.0
}

/// `out[p] = f(patch)` for every patch.
fn for_each_patch<T: Send>(surface: &Surface, out: &mut [T], f: impl Fn(&[u32]) -> T + Sync) {
    let ends = (0..surface.layer_count()).map(|layer| surface.layer_patches(layer).end as usize);
    parallel::pieces(out, ends, |layer, piece| {
        let mut slots = piece.iter_mut();
        surface.for_each_patch(layer, |patch, _| {
            slots.next().into_iter().for_each(|slot| *slot = f(patch));
        });
    });
}

/// Sums by the component of a vertex, always in the same order.
fn by_component(components: &Components, parts: impl Iterator<Item = (u32, f64)>) -> Vec<f64> {
    let mut sums = vec![0.0; components.count()];
    for (v, part) in parts {
        sums[components.of_vertices()[v as usize] as usize] += part;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::uniform;
    use crate::volume::{Border, FaceRule, phantom};

    #[test]
    fn the_gradient_is_that_of_differences() {
        let volume =
            phantom::noise(&crate::Grid::new([5, 6, 4], [1.0; 3]).unwrap(), 0.5, 3).unwrap();
        for rule in [FaceRule::Separate, FaceRule::Join] {
            let surface = Surface::extract(&volume, rule, Border::Closed).unwrap();
            let components = surface.components();
            let fans = Fans::new(&surface, &components);
            let count = surface.vertex_count();
            let x: Vec<f64> = (0..count).map(|v| 0.1 + 0.8 * uniform(7, v as u64)).collect();
            let gradient = fans.gradient(&x).slopes;
            for v in 0..count {
                let at = |shift: f64| {
                    let mut x = x.clone();
                    x[v] += shift;
                    fans.volumes(&x)[components.of_vertices()[v] as usize]
                };
                let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
                assert!((gradient[v] - difference).abs() < 1e-8, "{v}: {difference}");
            }
        }
    }
}
