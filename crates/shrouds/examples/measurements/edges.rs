//! Bodies with edges.

use shrouds::Grid;
use shrouds::volume::phantom;

use crate::bodies::{Body, Random, Shape};
use crate::measured::{Case, print};
use crate::{MESHES, PRESETS};

/// Bodies with sharp edges, along the grid and turned, and bodies as thin as one voxel.
pub(crate) fn edges() {
    let boxes = [[12.0, 16.0, 20.0], [24.0, 32.0, 40.0]];
    for sides in boxes {
        let shape = Shape::Rounded { sides, radius: 0.0 };
        for seed in 0..10 {
            let (body, volume) = Body::random(shape.clone(), [1.0; 3], &mut Random(seed));
            let name = format!("turned box {}x{}x{}", sides[0], sides[1], sides[2]);
            both_presets(&Case { name: &name, radius: 0.0, body: &body, volume: &volume });
        }
    }
    let thin = [[24.0, 24.0, 1.0], [24.0, 24.0, 2.0], [24.0, 1.0, 1.0], [24.0, 2.0, 2.0], [1.0; 3]];
    for sides in boxes.into_iter().chain(thin) {
        let counts = sides.map(|side| side as usize);
        let (grid, centre) = (counts.map(|n| n + 4), sides.map(|side| 1.5 + 0.5 * side));
        let shape = Shape::Rounded { sides, radius: 0.0 };
        let body = Body { shape, turn: phantom::IDENTITY, centre };
        let Ok(grid) = Grid::new(grid, [1.0; 3]) else { continue };
        let Ok(volume) = phantom::block(&grid, [2; 3], counts) else { continue };
        let name = format!("box {}x{}x{}", counts[0], counts[1], counts[2]);
        both_presets(&Case { name: &name, radius: 0.0, body: &body, volume: &volume });
    }
}

fn both_presets(case: &Case<'_>) {
    PRESETS.into_iter().for_each(|preset| print(case, preset, &MESHES[..1]));
}
