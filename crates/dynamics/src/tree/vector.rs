//! Vectors of space over any scalar.

use crate::scalar::Scalar;

/// Three components along the axes of a frame.
pub(super) type Vector<S> = [S; 3];

/// Rows of a matrix.
pub(super) type Rows<S> = [[S; 3]; 3];

pub(super) fn zero<S: Scalar>() -> Vector<S> {
    constant([0.0; 3])
}

/// Returns constant components as scalars.
pub(super) fn constant<S: Scalar>([x, y, z]: [f64; 3]) -> Vector<S> {
    [S::from(x), S::from(y), S::from(z)]
}

pub(super) fn add<S: Scalar>([a, b, c]: Vector<S>, [x, y, z]: Vector<S>) -> Vector<S> {
    [a + x, b + y, c + z]
}

pub(super) fn scaled<S: Scalar>([a, b, c]: Vector<S>, by: S) -> Vector<S> {
    [a * by, b * by, c * by]
}

pub(super) fn dot<S: Scalar>([a, b, c]: Vector<S>, [x, y, z]: Vector<S>) -> S {
    a * x + b * y + c * z
}

pub(super) fn cross<S: Scalar>([a, b, c]: Vector<S>, [x, y, z]: Vector<S>) -> Vector<S> {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// Returns the product of a matrix and a vector.
pub(super) fn times<S: Scalar>(rows: &Rows<S>, vector: Vector<S>) -> Vector<S> {
    rows.map(|row| dot(row, vector))
}

pub(super) fn transposed<S: Scalar>(rows: &Rows<S>) -> Rows<S> {
    let [[a, b, c], [d, e, f], [g, h, i]] = *rows;
    [[a, d, g], [b, e, h], [c, f, i]]
}

/// Returns the product of two matrices.
pub(super) fn product<S: Scalar>(left: &Rows<S>, right: &Rows<S>) -> Rows<S> {
    let columns = transposed(right);
    left.map(|row| columns.map(|column| dot(row, column)))
}

pub(super) fn sum<S: Scalar>(left: &Rows<S>, right: &Rows<S>) -> Rows<S> {
    let ([a, b, c], [x, y, z]) = (*left, *right);
    [add(a, x), add(b, y), add(c, z)]
}

/// Returns the matrix |d|²·1 − d dᵀ, which a unit mass at the distance d adds to an inertia.
pub(super) fn of_point<S: Scalar>(d: Vector<S>) -> Rows<S> {
    let square = dot(d, d);
    let [x, y, z] = d;
    [
        [square - x * x, -(x * y), -(x * z)],
        [-(y * x), square - y * y, -(y * z)],
        [-(z * x), -(z * y), square - z * z],
    ]
}

/// Returns the rotation by an angle about a unit axis (Rodrigues' formula).
pub(super) fn rotation<S: Scalar>(axis: [f64; 3], angle: S) -> Rows<S> {
    let (sine, cosine) = (angle.sin(), angle.cos());
    let [x, y, z] = constant::<S>(axis);
    let rest = -cosine + 1.0;
    [
        [cosine + x * x * rest, x * y * rest - z * sine, x * z * rest + y * sine],
        [y * x * rest + z * sine, cosine + y * y * rest, y * z * rest - x * sine],
        [z * x * rest - y * sine, z * y * rest + x * sine, cosine + z * z * rest],
    ]
}

/// Returns constant rows as scalars.
pub(super) fn constants<S: Scalar>(rows: &Rows<f64>) -> Rows<S> {
    rows.map(constant)
}
