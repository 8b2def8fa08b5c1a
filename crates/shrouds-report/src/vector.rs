//! Vectors in space.

/// A vector.
pub type Vector = [f64; 3];

/// `a − b`.
pub fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The inner product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length.
pub fn length(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

/// The same direction with length 1; along z if there is none.
pub fn unit(v: Vector) -> Vector {
    let l = length(v);
    if l > 0.0 { v.map(|x| x / l) } else { [0.0, 0.0, 1.0] }
}
