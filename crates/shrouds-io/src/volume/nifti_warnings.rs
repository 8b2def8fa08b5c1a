//! What is doubtful about the place of a NIfTI volume, in sentences.

use crate::volume::nifti_affine::Placement;

/// Relative difference of lengths, and cosine between axes, from which on they are worth a word:
/// headers hold 32-bit floats, some of them rounded to three digits.
const TOLERANCE: f64 = 1e-3;

impl Placement {
    /// Sentences about everything in the header that contradicts itself or is missing, each with
    /// what was made of it.
    pub(super) fn warnings(&self, dims: [usize; 3], unit: &str) -> Vec<String> {
        let mut warnings: Vec<String> =
            [self.forms_apart(dims, unit), self.shear(), self.spacings_apart(), self.quaternion()]
                .into_iter()
                .flatten()
                .collect();
        if self.sform_code <= 0 && self.qform_code <= 0 {
            let text = "Neither sform nor qform is set: the spacings alone were used, with the first \
                voxel at the origin; left and right are not known.";
            warnings.push(text.into());
        }
        let axes = (self.dimensions.max(0) as usize).min(3);
        let missing = (0..axes).any(|axis| self.pixdim[axis + 1] == 0.0 && dims[axis] == 1);
        if missing && self.sform_code <= 0 {
            warnings.push("A single slice has no spacing (pixdim 0): 1 was used.".into());
        }
        if unit == "unknown" {
            let text =
                "The header gives no unit of length (xyzt_units): numbers are kept as they are.";
            warnings.push(text.into());
        }
        warnings
    }

    /// Both forms are set, and place a corner more than half a voxel apart.
    fn forms_apart(&self, dims: [usize; 3], unit: &str) -> Option<String> {
        if self.sform_code <= 0 || self.qform_code <= 0 {
            return None;
        }
        let qform = self.qform(dims);
        let apart = |corner: usize| {
            let index: [f64; 3] =
                std::array::from_fn(|axis| (corner >> axis & 1) as f64 * (dims[axis] - 1) as f64);
            let squares = self.rows.iter().zip(&qform).map(|(s, q)| {
                let turned: f64 = (0..3).map(|c| (s[c] - q[c]) * index[c]).sum();
                (turned + s[3] - q[3]).powi(2)
            });
            squares.sum::<f64>().sqrt()
        };
        let most = (0..8).map(apart).fold(0.0, f64::max);
        let voxel = self.columns().map(length).into_iter().fold(f64::INFINITY, f64::min);
        (most > voxel / 2.0).then(|| {
            let unit = if unit == "unknown" { "units" } else { unit };
            format!(
                "The sform and the qform place a corner {most:.4} {unit} apart: the sform was used."
            )
        })
    }

    /// The axes of an sform that is used are not at right angles.
    fn shear(&self) -> Option<String> {
        let [x, y, z] = self.columns();
        let cosine = |u: [f64; 3], v: [f64; 3]| {
            (0..3).map(|r| u[r] * v[r]).sum::<f64>().abs() / (length(u) * length(v))
        };
        let most = cosine(x, y).max(cosine(y, z)).max(cosine(z, x));
        (self.sform_code > 0 && most > TOLERANCE).then(|| {
            format!(
                "The axes of the sform are not at right angles (cosine {most:.4}): positions keep the \
                 shear, energies take the axes as orthogonal."
            )
        })
    }

    /// `pixdim` disagrees with an sform that is used.
    fn spacings_apart(&self) -> Option<String> {
        let lengths = self.columns().map(length);
        let axes = (self.dimensions.max(0) as usize).min(3);
        let differs =
            |axis: usize| (self.pixdim[axis + 1] - lengths[axis]).abs() > TOLERANCE * lengths[axis];
        (self.sform_code > 0 && (0..axes).any(differs)).then(|| {
            let [x, y, z] = lengths;
            format!(
                "pixdim gives the spacing {:?}, the sform {x} x {y} x {z}: the sform was used.",
                &self.pixdim[1..=axes]
            )
        })
    }

    /// The vector part of a quaternion that is used is longer than that of any turn.
    fn quaternion(&self) -> Option<String> {
        let long = length(self.quaternion);
        (self.sform_code <= 0 && self.qform_code > 0 && long > 1.0 + TOLERANCE).then(|| {
            format!(
                "The quaternion of the qform has the length {long:.4}, more than 1: it was taken as a \
                 half turn about its axis."
            )
        })
    }

    fn columns(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|axis| self.rows.map(|row| row[axis]))
    }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
