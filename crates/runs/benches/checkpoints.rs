//! Cost of a checkpoint: a sealed write, flushed to disk, for states of several sizes.
//!
//! Run with `cargo bench -p runs`. The files go to the system's folder for temporary files; `TMPDIR` selects
//! another disk.

#![allow(missing_docs, clippy::expect_used, reason = "a benchmark")]

use runs::RunFolder;

/// Sizes in bytes: a perceptron under Levenberg-Marquardt, an amortized network under Adam with its trace, a
/// thousand fits.
const SIZES: [usize; 3] = [3_000, 100_000, 3_000_000];

#[divan::bench(args = SIZES)]
fn keep(bencher: divan::Bencher<'_, '_>, bytes: usize) {
    let scratch = tempfile::tempdir().expect("there is a place for temporary files");
    let folder = RunFolder::create_at(&scratch.path().join("run")).expect("it can be written");
    let state: Vec<u8> = (0..bytes).map(|at| (at % 251) as u8).collect();
    folder.write_checkpoint("state", &state).expect("it can be written");
    let kept = folder.read_checkpoint("state").expect("it is whole");
    assert!(kept.as_ref() == Some(&state));
    bencher.bench(|| folder.write_checkpoint("state", &state).expect("it can be written"));
}

#[divan::bench(args = SIZES)]
fn read(bencher: divan::Bencher<'_, '_>, bytes: usize) {
    let scratch = tempfile::tempdir().expect("there is a place for temporary files");
    let folder = RunFolder::create_at(&scratch.path().join("run")).expect("it can be written");
    folder.write_checkpoint("state", &vec![7; bytes]).expect("it can be written");
    assert_eq!(folder.read_checkpoint("state").expect("it is whole"), Some(vec![7; bytes]));
    bencher.bench(|| folder.read_checkpoint("state").expect("it is whole"));
}

fn main() {
    divan::main();
}
