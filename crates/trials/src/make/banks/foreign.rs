//! Cases of laws outside the vocabulary.
//!
//! Their sizes count only what remains after a recalibration and the nearest effects of the vocabulary have
//! absorbed what they can; otherwise `unknown` would be no better an answer than the surrogate effect.

use super::own_record::{Told, written};
use crate::Foreign;
use crate::make::case::Case;
use crate::make::draws::Draws;
use crate::make::error::TrialError;
use crate::make::integrator::motions;
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::make::setup::{ATTEMPTS, Setup};
use crate::make::unlisted;

/// Makes a case of the bank.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let ((law, absorbed), wanted) = plan.turn(job.number, &unlisted::alone())?;
    let kind_of_motion = job.free_motions(plan.seed);
    for attempt in 0..ATTEMPTS {
        let setup = Setup::draw(plan, job, attempt, kind_of_motion, &[])?;
        let (open, words) = (law.draw)(&setup.situation, &mut Draws::new(&setup.seed.child(law.name)));
        let Some(sized) = setup.sized(&open, wanted, absorbed)? else { continue };
        let motions = motions(&setup.situation, &[sized.law.as_ref()], &|_| Vec::new())?;
        let (name, size) = (law.name, sized.size);
        let foreign = Foreign {
            law: format!("{name}: {words}, size {size:.3e} (detectability beyond its stand-ins)"),
            detectability: sized.detectability,
        };
        let told = Told { foreign: Some(foreign), made: format!("{name} by splitting"), ..Told::default() };
        return written(plan, job, id, &setup, &motions, told);
    }
    Err(TrialError::OutOfReach { effect: law.name.to_owned(), wanted, attempts: ATTEMPTS })
}
