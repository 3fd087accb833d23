//! Direct integration of the equation of motion, against which the closed forms are tested.

/// ẍ + 2λẋ + βẋ|ẋ| + ω²x + ω²·x_c·sgn ẋ = 0.
pub(crate) struct Oscillator {
    pub(crate) omega: f64,
    /// λ.
    pub(crate) linear: f64,
    /// β.
    pub(crate) quadratic: f64,
    /// x_c.
    pub(crate) dead_zone: f64,
}

impl Oscillator {
    /// Returns times and amplitudes of `count` turning points from rest at `initial`.
    pub(crate) fn turning_points(&self, initial: f64, count: usize) -> Vec<(f64, f64)> {
        let step = 2e-4 / self.omega;
        let (mut time, mut position) = (0.0, initial);
        let mut points = vec![(0.0, initial.abs())];
        while points.len() < count {
            let direction = -position.signum();
            let mut velocity = 0.0;
            loop {
                let (next_position, next_velocity) = self.step(position, velocity, direction, step);
                if next_velocity * direction < 0.0 {
                    // The turning point lies within this step: the velocity is linear over it.
                    let share = velocity / (velocity - next_velocity);
                    let (at, _) = self.step(position, velocity, direction, share * step);
                    (time, position) = (time + share * step, at);
                    break;
                }
                (position, velocity) = (next_position, next_velocity);
                time += step;
            }
            points.push((time, position.abs()));
        }
        points
    }

    fn acceleration(&self, position: f64, velocity: f64, direction: f64) -> f64 {
        let friction = self.omega.powi(2) * self.dead_zone * direction;
        let drag = (2.0 * self.linear + self.quadratic * velocity.abs()) * velocity;
        -drag - self.omega.powi(2) * position - friction
    }

    /// Makes a classical Runge–Kutta step of fourth order.
    fn step(&self, x: f64, v: f64, direction: f64, h: f64) -> (f64, f64) {
        let f = |x: f64, v: f64| (v, self.acceleration(x, v, direction));
        let a = f(x, v);
        let b = f(x + 0.5 * h * a.0, v + 0.5 * h * a.1);
        let c = f(x + 0.5 * h * b.0, v + 0.5 * h * b.1);
        let d = f(x + h * c.0, v + h * c.1);
        let sum = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * (b + c) + d);
        (x + sum(a.0, b.0, c.0, d.0), v + sum(a.1, b.1, c.1, d.1))
    }
}
