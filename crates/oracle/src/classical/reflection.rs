//! Steps of the trust-region reflective method: the subproblem in the ball, and the effect of the bounds on
//! its solution.

use super::jacobi::decompose;
use super::vectors::{add_scaled, combine, dot, length, times};

/// Model m(s) = ½‖B·s‖² + g·s, with the singular values of B.
pub(super) struct Model {
    columns: Vec<Vec<f64>>,
    gradient: Vec<f64>,
    right: Vec<Vec<f64>>,
    values: Vec<f64>,
    /// The product Vᵀg.
    turned: Vec<f64>,
}

impl Model {
    pub(super) fn new(columns: Vec<Vec<f64>>, gradient: Vec<f64>) -> Self {
        let parts = decompose(columns.clone());
        let turned = parts.right.iter().map(|v| dot(v, &gradient)).collect();
        Self { columns, gradient, right: parts.right, values: parts.values, turned }
    }

    pub(super) fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Returns the model at a step; a negative value is a gain.
    pub(super) fn value(&self, step: &[f64]) -> f64 {
        let image = combine(&self.columns, step);
        dot(&image, &image).mul_add(0.5, dot(&self.gradient, step))
    }

    /// Returns the model's minimum in the ball, by Newton's method on the length of −V·(Vᵀg/(σ² + α)).
    pub(super) fn within(&self, radius: f64) -> Vec<f64> {
        let largest = self.values.iter().copied().fold(0.0, f64::max);
        let smallest = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let full_rank = smallest > f64::EPSILON * self.columns.len() as f64 * largest;
        let mut low = 0.0;
        if full_rank {
            let newton = self.step(0.0);
            let size = length(&newton);
            if size <= radius {
                return newton;
            }
            low = (size - radius) / self.decrease(0.0, size);
        }
        let mut high = length(&self.turned) / radius;
        let mut damping = f64::max(1e-3 * high, (low * high).sqrt());
        for _ in 0..20 {
            if damping < low || damping > high {
                damping = f64::max(1e-3 * high, (low * high).sqrt());
            }
            let size = length(&self.step(damping));
            let misfit = size - radius;
            if misfit.abs() < 0.01 * radius {
                break;
            }
            let slope = self.decrease(damping, size);
            if misfit < 0.0 {
                high = damping;
            }
            low = f64::max(low, damping + misfit / slope);
            damping += misfit / slope * size / radius;
        }
        let mut step = self.step(damping);
        // The step is put on the sphere, so that the next damping does not start further out.
        let size = length(&step);
        if size > 0.0 {
            step.iter_mut().for_each(|x| *x *= radius / size);
        }
        step
    }

    fn step(&self, damping: f64) -> Vec<f64> {
        let shares: Vec<f64> = self
            .turned
            .iter()
            .zip(&self.values)
            .map(|(g, value)| if *g == 0.0 { 0.0 } else { -g / value.mul_add(*value, damping) })
            .collect();
        combine(&self.right, &shares)
    }

    /// Returns minus the derivative of the step's length by the damping.
    fn decrease(&self, damping: f64, size: f64) -> f64 {
        self.turned
            .iter()
            .zip(&self.values)
            .map(|(g, value)| g * g / value.mul_add(*value, damping).powi(3))
            .sum::<f64>()
            / size
    }

    /// Returns the factor in low..=high of `direction` that minimizes the model from `from` on, and the value
    /// there.
    fn along(&self, from: &[f64], direction: &[f64], low: f64, high: f64) -> (f64, f64) {
        let image = combine(&self.columns, direction);
        let base = combine(&self.columns, from);
        let curvature = 0.5 * dot(&image, &image);
        let slope = dot(&base, &image) + dot(&self.gradient, direction);
        let constant = self.value(from);
        let at = |factor: f64| (factor, factor.mul_add(factor.mul_add(curvature, slope), constant));
        let inner = -0.5 * slope / curvature;
        let ends = if at(low).1 <= at(high).1 { at(low) } else { at(high) };
        if curvature > 0.0 && inner > low && inner < high && at(inner).1 < ends.1 { at(inner) } else { ends }
    }
}

/// Box of lower and upper bounds.
pub(super) struct Walls<'a> {
    pub(super) low: &'a [f64],
    pub(super) high: &'a [f64],
}

impl Walls<'_> {
    pub(super) fn contain(&self, x: &[f64]) -> bool {
        x.iter().zip(self.low.iter().zip(self.high)).all(|(x, (low, high))| low < x && x < high)
    }

    /// Returns the largest factor of a direction that stays in the box, and which walls limit it.
    fn reach(&self, x: &[f64], direction: &[f64]) -> (f64, Vec<bool>) {
        let room: Vec<f64> = x
            .iter()
            .zip(direction)
            .zip(self.low.iter().zip(self.high))
            .map(|((x, d), (low, high))| match *d {
                d if d > 0.0 => (high - x) / d,
                d if d < 0.0 => (low - x) / d,
                _ => f64::INFINITY,
            })
            .collect();
        let least = room.iter().copied().fold(f64::INFINITY, f64::min);
        (least, room.iter().map(|room| *room == least).collect())
    }

    /// Returns the nearest point strictly inside.
    pub(super) fn inside(&self, x: &[f64]) -> Vec<f64> {
        x.iter()
            .zip(self.low.iter().zip(self.high))
            .map(|(x, (low, high))| {
                let inner = x.max(low.next_up()).min(high.next_down());
                // Adjacent bounds have no number strictly between them.
                if *low < inner && inner < *high { inner } else { f64::midpoint(*low, *high) }
            })
            .collect()
    }
}

/// Selects the best of three steps in scaled variables s (x moves by d∘s): the trust-region step cut off
/// before the walls, the same step reflected at the first wall, and the step along the gradient. Returns s
/// and the model's value.
///
/// Reference: Branch, Coleman, Li, SIAM J. Sci. Comput. 21 (1999) 1, section 4.
pub(super) fn select(
    model: &Model,
    walls: &Walls,
    x: &[f64],
    scale: &[f64],
    radius: f64,
    share: f64,
) -> (Vec<f64>, f64) {
    let step = model.within(radius);
    let moved = |s: &[f64]| {
        let mut x = x.to_vec();
        add_scaled(&mut x, 1.0, &times(scale, s));
        x
    };
    if walls.contain(&moved(&step)) {
        let value = model.value(&step);
        return (step, value);
    }
    let (room, hits) = walls.reach(x, &times(scale, &step));
    let to_wall: Vec<f64> = step.iter().map(|s| s * room).collect();

    let cut: Vec<f64> = to_wall.iter().map(|s| s * share).collect();
    let mut best = (model.value(&cut), cut);

    let mut reflected = step.clone();
    for (s, hit) in reflected.iter_mut().zip(&hits) {
        if *hit {
            *s = -*s;
        }
    }
    let (next_room, _) = walls.reach(&moved(&to_wall), &times(scale, &reflected));
    let to_sphere = exit(&to_wall, &reflected, radius);
    let (low, high) = if next_room < to_sphere {
        ((1.0 - share) * room / next_room, share * next_room)
    } else {
        ((1.0 - share) * room / to_sphere, to_sphere)
    };
    if high > 0.0 && low <= high {
        let (factor, value) = model.along(&to_wall, &reflected, low, high);
        if value < best.0 {
            let mut s = to_wall;
            add_scaled(&mut s, factor, &reflected);
            best = (value, s);
        }
    }

    let down: Vec<f64> = model.gradient().iter().map(|g| -g).collect();
    let to_sphere = radius / length(&down);
    let (room, _) = walls.reach(x, &times(scale, &down));
    let most = if room < to_sphere { share * room } else { to_sphere };
    let (factor, value) = model.along(&vec![0.0; down.len()], &down, 0.0, most);
    if value < best.0 {
        best = (value, down.iter().map(|s| s * factor).collect());
    }
    (best.1, best.0)
}

/// Returns the factor of a direction at which a ray from inside a ball leaves it.
fn exit(from: &[f64], direction: &[f64], radius: f64) -> f64 {
    let (a, b) = (dot(direction, direction), dot(from, direction));
    let c = dot(from, from) - radius * radius;
    let root = (b * b - a * c).max(0.0).sqrt();
    if b > 0.0 { -c / (b + root) } else { (root - b) / a }
}

#[cfg(test)]
mod tests {
    use super::{Model, Walls, exit, select};
    use crate::classical::vectors::{add_scaled, combine, dot, length, times};
    use rand::RngExt;
    use seed::Seed;

    #[test]
    fn the_step_in_the_ball_solves_the_damped_equations() {
        let model = Model::new(vec![vec![2.0, 0.0, 1.0], vec![1.0, 3.0, -1.0]], vec![-4.0, 7.0]);
        let free = model.within(1e3);
        // BᵀB = [[5, 1], [1, 11]].
        assert!((5.0 * free[0] + free[1] - 4.0).abs() < 1e-13, "{free:?}");
        assert!((free[0] + 11.0 * free[1] + 7.0).abs() < 1e-13, "{free:?}");
        let held = model.within(0.3);
        assert!((length(&held) - 0.3).abs() < 1e-15);
        // −g − BᵀB·s is parallel to s, to within the hundredth that the damping is found to.
        let rest = [4.0 - 5.0 * held[0] - held[1], -7.0 - held[0] - 11.0 * held[1]];
        assert!((rest[0] * held[1] - rest[1] * held[0]).abs() < 0.02 * 8.0 * 0.3);
    }

    #[test]
    fn a_singular_model_still_gives_a_step() {
        let model = Model::new(vec![vec![1.0, 1.0], vec![1.0, 1.0]], vec![1.0, 0.0]);
        assert!((length(&model.within(2.0)) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_ray_leaves_the_ball_on_the_sphere() {
        for direction in [[1.0, 2.0], [-1.0, 0.5]] {
            let from = [0.5, -0.25];
            let t = exit(&from, &direction, 2.0);
            let end = [from[0] + t * direction[0], from[1] + t * direction[1]];
            assert!(t > 0.0 && (length(&end) - 2.0).abs() < 1e-14);
        }
    }

    /// Models of two to four parameters, with curvatures up to 10⁴ apart.
    fn models() -> Vec<Model> {
        let mut generator = Seed::new(12).generator();
        (0..200)
            .map(|number| {
                let size = 2 + number % 3;
                let columns = (0..size).map(|_| {
                    let scale = 10_f64.powf(generator.random_range(-2.0..2.0));
                    (0..size + 2).map(|_| scale * generator.random_range(-1.0..1.0)).collect()
                });
                let columns = columns.collect();
                Model::new(columns, (0..size).map(|_| generator.random_range(-1.0..1.0)).collect())
            })
            .collect()
    }

    #[test]
    fn the_model_is_half_a_square_and_a_slope() {
        let model = Model::new(vec![vec![2.0, 0.0, 1.0], vec![1.0, 3.0, -1.0]], vec![-4.0, 7.0]);
        // ½·(5s² + 2st + 11t²) − 4s + 7t.
        assert!((model.value(&[1.0, 2.0]) - (0.5 * 53.0 + 10.0)).abs() < 1e-13);
        assert_eq!(model.gradient(), [-4.0, 7.0]);
        assert_eq!(model.value(&[0.0, 0.0]), 0.0);
    }

    /// Damped steps solve (BᵀB + α)·s = −g, and −d‖s‖/dα is right.
    #[test]
    fn damped_steps_solve_their_equations_and_shorten_as_said() {
        for model in models() {
            for damping in [0.1, 3.0] {
                let step = model.step(damping);
                let image = combine(&model.columns, &step);
                for ((column, s), g) in model.columns.iter().zip(&step).zip(&model.gradient) {
                    let left = dot(column, &image) + damping * s;
                    assert!((left + g).abs() < 1e-8 * (1.0 + damping), "{left} {g}");
                }
                let h = 1e-5 * damping;
                let size = |damping| length(&model.step(damping));
                let difference = (size(damping - h) - size(damping + h)) / (2.0 * h);
                let stated = model.decrease(damping, size(damping));
                assert!((stated / difference - 1.0).abs() < 1e-5, "{stated} {difference}");
            }
        }
    }

    /// The step lies on the sphere, and no other point of the ball is better by more than the hundredth that
    /// the radius is met to.
    #[test]
    fn the_step_in_the_ball_is_the_best_in_it() {
        let mut generator = Seed::new(13).generator();
        for model in models() {
            let free = length(&model.within(f64::MAX));
            for share in [0.01, 0.3, 0.9, 0.999, 1.5] {
                let radius = share * free;
                let step = model.within(radius);
                let size = length(&step);
                if share > 1.0 {
                    assert!((size / free - 1.0).abs() < 1e-9);
                } else {
                    assert!((size / radius - 1.0).abs() < 1e-12, "{size} {radius}");
                }
                let value = model.value(&step);
                assert!(value < 0.0);
                for _ in 0..50 {
                    let other: Vec<f64> = step.iter().map(|_| generator.random_range(-1.0..1.0)).collect();
                    let factor = radius * generator.random::<f64>() / length(&other);
                    let other: Vec<f64> = other.iter().map(|x| x * factor).collect();
                    assert!(model.value(&other) >= 1.02 * value, "{} {value}", model.value(&other));
                }
            }
        }
    }

    #[test]
    fn along_a_ray_the_least_of_the_model_is_found() {
        for model in models() {
            let size = model.gradient.len();
            let (from, direction) =
                (vec![0.1; size], model.gradient.iter().map(|g| -g).collect::<Vec<f64>>());
            for (low, high) in [(0.0, 1e-4), (0.0, 10.0), (2.0, 3.0)] {
                let (factor, value) = model.along(&from, &direction, low, high);
                let at = |factor: f64| {
                    let mut s = from.clone();
                    add_scaled(&mut s, factor, &direction);
                    model.value(&s)
                };
                assert!((low..=high).contains(&factor));
                let room = 1e-9 * at(low).abs().max(at(high).abs());
                assert!((at(factor) - value).abs() <= room, "{} {value}", at(factor));
                for step in 0..=100 {
                    assert!(at(low + (high - low) * f64::from(step) / 100.0) >= value - room);
                }
            }
        }
    }

    const BOX: Walls = Walls { low: &[-1.0, 0.0], high: &[3.0, f64::INFINITY] };

    #[test]
    fn a_box_ends_at_its_walls() {
        assert!(BOX.contain(&[0.0, 1.0]) && BOX.contain(&[2.999, 1e9]));
        for x in [[-1.0, 1.0], [3.0, 1.0], [0.0, 0.0], [0.0, -1.0], [4.0, 1.0], [-2.0, 1.0]] {
            assert!(!BOX.contain(&x), "{x:?}");
            let inner = BOX.inside(&x);
            assert!(BOX.contain(&inner), "{inner:?}");
            assert!(x.iter().zip(&inner).all(|(x, inner)| (x - inner).abs() <= 1.0 + 1e-15));
        }
        assert_eq!(BOX.inside(&[0.5, 2.0]), [0.5, 2.0]);
        let tight = Walls { low: &[1.0], high: &[1.0 + f64::EPSILON] };
        assert!((tight.inside(&[7.0])[0] - 1.0).abs() <= f64::EPSILON);
    }

    #[test]
    fn the_way_to_the_walls_by_hand() {
        for (direction, room, hits) in [
            ([1.0, 0.0], 2.0, [true, false]),
            ([-4.0, 1.0], 0.5, [true, false]),
            ([0.0, -2.0], 0.25, [false, true]),
            ([1.0, -0.25], 2.0, [true, true]),
            ([-2.0, -1.0], 0.5, [false, true]),
        ] {
            let found = BOX.reach(&[1.0, 0.5], &direction);
            assert_eq!(found, (room, hits.to_vec()), "{direction:?}");
        }
        assert_eq!(BOX.reach(&[1.0, 0.5], &[0.0, 1.0]).0, f64::INFINITY);
        assert_eq!(BOX.reach(&[1.0, 0.5], &[0.0, 0.0]).0, f64::INFINITY);
    }

    /// The chosen step lies inside box and ball, has the stated value, and is no worse than the step cut off
    /// before the wall or any point on the gradient's ray.
    #[test]
    fn the_chosen_step_is_the_best_of_those_that_stay_inside() {
        const SHARE: f64 = 0.995;
        let mut generator = Seed::new(14).generator();
        let (mut cut_short, mut better_than_cut) = (0, 0);
        for model in models() {
            let size = model.gradient.len();
            let x: Vec<f64> = (0..size).map(|_| generator.random_range(0.05..0.95)).collect();
            let scale: Vec<f64> = (0..size).map(|_| generator.random_range(0.2..2.0)).collect();
            let (low, high) = (vec![0.0; size], vec![1.0; size]);
            let walls = Walls { low: &low, high: &high };
            let at = |s: &[f64]| x.iter().zip(times(&scale, s)).map(|(x, s)| x + s).collect::<Vec<f64>>();
            for radius in [0.05, 0.5, 5.0] {
                let (step, value) = select(&model, &walls, &x, &scale, radius, SHARE);
                assert!(walls.contain(&at(&step)) && length(&step) <= radius * (1.0 + 1e-9), "{step:?}");
                assert!((model.value(&step) - value).abs() <= 1e-9 * value.abs(), "{value}");
                let whole = model.within(radius);
                if walls.contain(&at(&whole)) {
                    assert_eq!(step, whole);
                    continue;
                }
                cut_short += 1;
                let room = SHARE * walls.reach(&x, &times(&scale, &whole)).0;
                let cut = model.value(&whole.iter().map(|s| s * room).collect::<Vec<f64>>());
                assert!(value <= cut + 1e-12 * cut.abs(), "{value} {cut}");
                better_than_cut += u32::from(value < cut - 1e-6 * cut.abs());
                let down: Vec<f64> = model.gradient.iter().map(|g| -g).collect();
                let most = f64::min(radius / length(&down), SHARE * walls.reach(&x, &times(&scale, &down)).0);
                for part in 0..=50 {
                    let factor = most * f64::from(part) / 50.0;
                    let s: Vec<f64> = down.iter().map(|s| s * factor).collect();
                    assert!(value <= model.value(&s) + 1e-12, "{value}");
                }
            }
        }
        assert!(cut_short > 100 && better_than_cut > 0, "{cut_short} {better_than_cut}");
    }

    /// For m(s) = ½|s|² + g·s with a wall at s₁ = 1, the step goes straight to the wall and is reflected
    /// there.
    #[test]
    fn a_step_is_reflected_at_the_wall() {
        let model = Model::new(vec![vec![1.0, 0.0], vec![0.0, 1.0]], vec![-4.0, -4.0]);
        let walls = Walls { low: &[f64::NEG_INFINITY; 2], high: &[1.0, f64::INFINITY] };
        let (step, value) = select(&model, &walls, &[0.0, 0.0], &[1.0, 1.0], 1e3, 0.995);
        // From (1, 1) along (−4, 4) the model only rises: the best step ends next to the wall.
        assert!(step.iter().all(|s| (s - 1.0).abs() < 1e-3) && step[0] < 1.0, "{step:?}");
        assert!((value + 7.0).abs() < 1e-3, "{value}");
        // With a steeper slope along the wall the reflected step goes further.
        let model = Model::new(vec![vec![1.0, 0.0], vec![0.0, 1.0]], vec![-4.0, -12.0]);
        let (step, _) = select(&model, &walls, &[0.0, 0.0], &[1.0, 1.0], 1e3, 0.995);
        // From (1, 3) along (−4, 12): slope −(1 − 4)·4 + (3 − 12)·12 = −96, curvature 160: t = 0.6.
        assert!((step[0] + 1.4).abs() < 1e-9 && (step[1] - 10.2).abs() < 1e-9, "{step:?}");
    }
}
