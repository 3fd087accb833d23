//! Parallel processing of all cases.

use crate::error::TrainerError;
use crate::terminal::progress::Progress;
use estimator::Cancel;
use rayon::ThreadPool;
use rayon::prelude::*;

/// Applies `one` to every case in parallel and returns the results in order; `None` if interrupted.
pub(crate) fn each<C: Sync, T: Send>(
    cases: &[C],
    pool: &ThreadPool,
    cancel: &Cancel,
    progress: &Progress,
    one: impl Fn(&C) -> Result<T, TrainerError> + Sync,
) -> Result<Option<Vec<T>>, TrainerError> {
    let done: Vec<Option<T>> = pool.install(|| {
        let all = cases.par_iter().map(|case| {
            if cancel.is_requested() {
                return Ok(None);
            }
            let done = one(case)?;
            progress.one_of_many_done();
            Ok(Some(done))
        });
        all.collect::<Result<_, TrainerError>>()
    })?;
    progress.finish();
    Ok(done.into_iter().collect())
}
