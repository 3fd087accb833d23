//! Recursive Newton–Euler and composite-rigid-body algorithms, in the frames of the bodies.

use super::body::{Body, Inertia, JointMotion};
use super::error::TreeError;
use super::structure::Tree;
use super::vector::{
    Rows, Vector, add, constant, constants, cross, dot, of_point, product, rotation, scaled, sum, times,
    transposed, zero,
};
use crate::scalar::Scalar;

/// Frame of a body in that of its parent, at the present position of its joint.
struct Frame<S> {
    origin: Vector<S>,
    rotation: Rows<S>,
}

/// Motion of a body along its own axes; the acceleration of its origin includes that of free fall.
#[derive(Clone, Copy)]
struct Moving<S> {
    turning: Vector<S>,
    turning_rate: Vector<S>,
    acceleration: Vector<S>,
}

/// Torque about the origin of a body and force on it.
#[derive(Clone, Copy)]
struct Wrench<S> {
    torque: Vector<S>,
    force: Vector<S>,
}

/// Mass, mass times center and moments about the origin, of a body or of all bodies beyond a joint.
#[derive(Clone, Copy)]
struct Composite<S> {
    mass: S,
    first: Vector<S>,
    second: Rows<S>,
}

impl<S: Scalar> Frame<S> {
    fn of(body: &Body, position: S) -> Self {
        let rows = constants(&body.placement.rotation);
        let origin = constant(body.placement.origin);
        match body.motion {
            JointMotion::Fixed => Self { origin, rotation: rows },
            JointMotion::Revolute(axis) => {
                Self { origin, rotation: product(&rows, &rotation(axis, position)) }
            }
            JointMotion::Prismatic(axis) => {
                Self { origin: add(origin, scaled(times(&rows, constant(axis)), position)), rotation: rows }
            }
        }
    }

    /// Returns a torque and a force on the body as those on its parent.
    fn to_parent(&self, own: Wrench<S>) -> Wrench<S> {
        let force = times(&self.rotation, own.force);
        Wrench { torque: add(times(&self.rotation, own.torque), cross(self.origin, force)), force }
    }
}

impl<S: Scalar> Composite<S> {
    fn of(inertia: &Inertia) -> Self {
        let center = constant(inertia.center);
        let mass = S::from(inertia.mass);
        let point = of_point::<S>(center).map(|row| scaled(row, mass));
        Self { mass, first: scaled(center, mass), second: sum(&constants(&inertia.moments), &point) }
    }

    /// Returns the composite in the frame of the parent.
    fn in_parent(&self, frame: &Frame<S>) -> Self {
        let first = times(&frame.rotation, self.first);
        let turned = product(&frame.rotation, &product(&self.second, &transposed(&frame.rotation)));
        // ∫ |x + p|²·1 − (x + p)(x + p)ᵀ dm, with ∫ x dm = `first` and p the origin of the frame.
        let p = frame.origin;
        let mixed = {
            let twice = dot(p, first) + dot(p, first);
            let ([px, py, pz], [fx, fy, fz]) = (p, first);
            let off = |a: S, b: S, c: S, d: S| -(a * d + b * c);
            [
                [twice - (px * fx + px * fx), off(px, py, fx, fy), off(px, pz, fx, fz)],
                [off(px, py, fx, fy), twice - (py * fy + py * fy), off(py, pz, fy, fz)],
                [off(px, pz, fx, fz), off(py, pz, fy, fz), twice - (pz * fz + pz * fz)],
            ]
        };
        let point = of_point(p).map(|row| scaled(row, self.mass));
        Self {
            mass: self.mass,
            first: add(first, scaled(p, self.mass)),
            second: sum(&turned, &sum(&mixed, &point)),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: add(self.first, other.first),
            second: sum(&self.second, &other.second),
        }
    }

    /// Returns torque and force that accelerate the composite, at rest, along a joint by 1.
    fn accelerated(&self, motion: JointMotion) -> Wrench<S> {
        match motion {
            JointMotion::Fixed => Wrench { torque: zero(), force: zero() },
            JointMotion::Revolute(axis) => {
                let axis = constant(axis);
                Wrench { torque: times(&self.second, axis), force: cross(axis, self.first) }
            }
            JointMotion::Prismatic(axis) => {
                let axis = constant(axis);
                Wrench { torque: cross(self.first, axis), force: scaled(axis, self.mass) }
            }
        }
    }

    /// Returns torque and force that a motion needs.
    fn moved(&self, own: &Moving<S>) -> Wrench<S> {
        let Moving { turning, turning_rate, acceleration } = *own;
        let spin = times(&self.second, turning);
        let torque = add(times(&self.second, turning_rate), cross(turning, spin));
        let swing = add(cross(turning_rate, self.first), cross(turning, cross(turning, self.first)));
        Wrench {
            torque: add(torque, cross(self.first, acceleration)),
            force: add(scaled(acceleration, self.mass), swing),
        }
    }
}

/// Returns the part of a torque and a force that acts along a joint.
fn along<S: Scalar>(motion: JointMotion, own: &Wrench<S>) -> S {
    match motion {
        JointMotion::Fixed => S::from(0.0),
        JointMotion::Revolute(axis) => dot(constant(axis), own.torque),
        JointMotion::Prismatic(axis) => dot(constant(axis), own.force),
    }
}

/// Returns the motion of a body from that of its parent.
fn moving<S: Scalar>(
    parent: &Moving<S>,
    frame: &Frame<S>,
    motion: JointMotion,
    (velocity, rate): (S, S),
) -> Moving<S> {
    let back = transposed(&frame.rotation);
    let Moving { turning, turning_rate, acceleration } = *parent;
    let swing = add(cross(turning_rate, frame.origin), cross(turning, cross(turning, frame.origin)));
    let turned = times(&back, turning);
    let carried = Moving {
        turning: turned,
        turning_rate: times(&back, turning_rate),
        acceleration: times(&back, add(acceleration, swing)),
    };
    match motion {
        JointMotion::Fixed => carried,
        JointMotion::Revolute(axis) => {
            let axis = constant(axis);
            let own = scaled(axis, velocity);
            Moving {
                turning: add(turned, own),
                turning_rate: add(add(carried.turning_rate, scaled(axis, rate)), cross(turned, own)),
                ..carried
            }
        }
        JointMotion::Prismatic(axis) => {
            let axis = constant(axis);
            let own = scaled(axis, velocity);
            let coriolis = scaled(cross(turned, own), S::from(2.0));
            Moving { acceleration: add(carried.acceleration, add(scaled(axis, rate), coriolis)), ..carried }
        }
    }
}

impl Tree {
    /// Returns the value of each body's joint: 0 for a fixed one.
    fn by_body<S: Scalar>(&self, values: &[S]) -> Result<Vec<S>, TreeError> {
        self.check(values)?;
        let mut values = values.iter().copied();
        let value = |body: &Body| match body.motion {
            JointMotion::Fixed => S::from(0.0),
            // The number of values was checked.
            _ => values.next().unwrap_or(S::from(0.0)),
        };
        Ok(self.bodies.iter().map(value).collect())
    }

    fn frames<S: Scalar>(&self, position: &[S]) -> Result<Vec<Frame<S>>, TreeError> {
        let positions = self.by_body(position)?;
        Ok(self.bodies.iter().zip(positions).map(|(body, own)| Frame::of(body, own)).collect())
    }

    /// Computes the torques (forces of prismatic joints) that a motion needs, without friction: the mass matrix
    /// times the accelerations, plus the [`Self::bias`]. Vectors have one entry for each joint that moves.
    ///
    /// # Errors
    /// [`TreeError::Length`] for vectors of another length.
    pub fn inverse_dynamics<S: Scalar>(
        &self,
        position: &[S],
        velocity: &[S],
        acceleration: &[S],
    ) -> Result<Vec<S>, TreeError> {
        let frames = self.frames(position)?;
        let (velocities, rates) = (self.by_body(velocity)?, self.by_body(acceleration)?);
        let ground = Moving {
            turning: zero(),
            turning_rate: zero(),
            acceleration: constant(self.gravity.map(|own| -own)),
        };
        let mut motions: Vec<Moving<S>> = Vec::with_capacity(self.bodies.len());
        for ((body, frame), rates) in
            self.bodies.iter().zip(&frames).zip(velocities.iter().copied().zip(rates.iter().copied()))
        {
            let parent = body.parent.and_then(|parent| motions.get(parent)).unwrap_or(&ground);
            motions.push(moving(parent, frame, body.motion, rates));
        }
        let needed = |(body, own): (&Body, &Moving<S>)| Composite::of(&body.inertia).moved(own);
        let mut wrenches: Vec<Wrench<S>> = self.bodies.iter().zip(&motions).map(needed).collect();
        let mut torques = Vec::with_capacity(position.len());
        for (at, (body, frame)) in self.bodies.iter().zip(&frames).enumerate().rev() {
            let (Some(own), Some(rate)) = (wrenches.get(at).copied(), rates.get(at)) else { continue };
            if body.motion != JointMotion::Fixed {
                torques.push(along(body.motion, &own) + *rate * body.armature);
            }
            if let Some(parent) = body.parent.and_then(|parent| wrenches.get_mut(parent)) {
                let passed = frame.to_parent(own);
                *parent = Wrench {
                    torque: add(parent.torque, passed.torque),
                    force: add(parent.force, passed.force),
                };
            }
        }
        torques.reverse();
        Ok(torques)
    }

    /// Computes the torques of gravity, Coriolis and centrifugal forces: those that a motion without acceleration
    /// needs.
    ///
    /// # Errors
    /// [`TreeError::Length`] for vectors of another length.
    pub fn bias<S: Scalar>(&self, position: &[S], velocity: &[S]) -> Result<Vec<S>, TreeError> {
        self.inverse_dynamics(position, velocity, &vec![S::from(0.0); position.len()])
    }

    /// Computes the rows of the mass matrix, armatures included.
    ///
    /// # Errors
    /// [`TreeError::Length`] for a vector of another length.
    pub fn mass_matrix<S: Scalar>(&self, position: &[S]) -> Result<Vec<Vec<S>>, TreeError> {
        let frames = self.frames(position)?;
        let mut composites: Vec<Composite<S>> =
            self.bodies.iter().map(|body| Composite::of(&body.inertia)).collect();
        for (at, (body, frame)) in self.bodies.iter().zip(&frames).enumerate().rev() {
            let passed = composites.get(at).map(|own| own.in_parent(frame));
            let parent = body.parent.and_then(|parent| composites.get_mut(parent));
            if let (Some(passed), Some(parent)) = (passed, parent) {
                *parent = parent.plus(&passed);
            }
        }
        let count = self.joints();
        let mut number = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            number.push((body.motion != JointMotion::Fixed).then(|| number.iter().flatten().count()));
        }
        let mut matrix = vec![vec![S::from(0.0); count]; count];
        let mut set = |row: usize, column: usize, value: S| {
            for (row, column) in [(row, column), (column, row)] {
                if let Some(slot) = matrix.get_mut(row).and_then(|row| row.get_mut(column)) {
                    *slot = value;
                }
            }
        };
        let joint = |at: usize| number.get(at).copied().flatten();
        for (at, body) in self.bodies.iter().enumerate() {
            let (Some(row), Some(composite)) = (joint(at), composites.get(at)) else { continue };
            let mut own = composite.accelerated(body.motion);
            set(row, row, along(body.motion, &own) + body.armature);
            let mut below = at;
            while let (Some(frame), Some(parent)) =
                (frames.get(below), self.bodies.get(below).and_then(|body| body.parent))
            {
                own = frame.to_parent(own);
                below = parent;
                if let (Some(column), Some(other)) = (joint(parent), self.bodies.get(parent)) {
                    set(row, column, along(other.motion, &own));
                }
            }
        }
        Ok(matrix)
    }

    /// Computes the accelerations that torques cause.
    ///
    /// # Errors
    /// [`TreeError::Length`] for vectors of another length; [`TreeError::NoInertia`] where the mass matrix is
    /// singular.
    pub fn accelerations(
        &self,
        position: &[f64],
        velocity: &[f64],
        torque: &[f64],
    ) -> Result<Vec<f64>, TreeError> {
        self.check(torque)?;
        let bias = self.bias(position, velocity)?;
        let left: Vec<f64> = torque.iter().zip(bias).map(|(torque, bias)| torque - bias).collect();
        let name = |at: usize| self.names().nth(at).unwrap_or("").to_owned();
        solved(&self.mass_matrix(position)?, left).map_err(|at| TreeError::NoInertia { joint: name(at) })
    }
}

/// Solves a symmetric positive definite system, given by its rows, by elimination.
///
/// # Errors
/// The index of a pivot that is not above 0.
pub fn solved(matrix: &[Vec<f64>], mut right: Vec<f64>) -> Result<Vec<f64>, usize> {
    let mut rows: Vec<Vec<f64>> = matrix.to_vec();
    for at in 0..rows.len() {
        let (above, rest) = rows.split_at_mut(at + 1);
        let Some(pivot_row) = above.last() else { continue };
        let pivot = pivot_row.get(at).copied().filter(|pivot| *pivot > 0.0).ok_or(at)?;
        let (done, left) = right.split_at_mut(at + 1);
        let Some(known) = done.last().copied() else { continue };
        for (row, own) in rest.iter_mut().zip(left) {
            let Some(factor) = row.get(at).map(|own| own / pivot) else { continue };
            for (slot, value) in row.iter_mut().zip(pivot_row) {
                *slot -= factor * value;
            }
            *own -= factor * known;
        }
    }
    let mut solution: Vec<f64> = Vec::with_capacity(right.len());
    for (row, own) in rows.iter().zip(&right).rev() {
        let known: f64 = row.iter().rev().zip(&solution).map(|(a, b)| a * b).sum();
        let at = row.len() - 1 - solution.len();
        // Pivots were found to be above 0.
        let pivot = row.get(at).copied().unwrap_or(1.0);
        solution.push((own - known) / pivot);
    }
    solution.reverse();
    Ok(solution)
}
