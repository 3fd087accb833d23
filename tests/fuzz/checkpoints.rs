//! Fuzzing of fits that resume from arbitrary states: shared by the fuzzer and by the test that replays its
//! findings.
//!
//! The input is first sealed as a checkpoint, so that the fuzzer gets past the digest to the code that reads
//! the state. A fit either refuses a state or resumes from exactly that state within its budget. One flipped
//! bit of the sealed file is detected, whatever its content.

use envelope::Envelope;
use estimator::{Cancel, Checkpoints, Entry, Estimator, FitContext, FitError, Silent};
use runs::{RunError, RunFolder, Scratch};
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;
use std::sync::OnceLock;

/// Most steps of a fit.
const MOST_STEPS: u64 = 3;

/// Smallest values of all settings that have a size; each estimator uses those that it declares.
const SMALL: [(&str, &str); 7] = [
    ("hidden", "[2]"),
    ("collocation_points", "2"),
    ("hidden_units", "1"),
    ("longest_sequence", "4"),
    ("batch", "2"),
    ("calibration", "0"),
    ("peaks", "[5, 8]"),
];

/// Storage with a state to resume from and the states stored during the fit.
struct Place<'a> {
    latest: &'a [u8],
    kept: RefCell<Vec<Vec<u8>>>,
}

impl Checkpoints for Place<'_> {
    fn latest(&self) -> Option<Vec<u8>> {
        Some(self.latest.to_vec())
    }

    fn is_due(&self) -> bool {
        true
    }

    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String> {
        assert!(step <= MOST_STEPS, "kept before step {step} of {MOST_STEPS}");
        self.kept.borrow_mut().push(state.to_vec());
        Ok(())
    }
}

/// Resumes a fit in progress: the first byte selects the estimator, and the other bytes are the state.
pub(crate) fn checkpoint(data: &[u8], estimators: &[Entry]) {
    let Some((first, state)) = data.split_first() else { return };
    sealed(state);
    let estimator = small(&estimators[usize::from(*first) % estimators.len()]);
    let Some(kept) = go_on(&*estimator, state) else { return };
    // A state may have several encodings, but a fit always writes the same one.
    let [first, ..] = &kept[..] else { panic!("a fit that goes on keeps what it goes on from") };
    assert_eq!(go_on(&*estimator, first).as_ref(), Some(&kept), "the same state, another way on");
}

/// Checks that a sealed content can be read again, and that it cannot with a flipped bit.
fn sealed(content: &[u8]) {
    static PLACE: OnceLock<Scratch> = OnceLock::new();
    let folder = RunFolder::open(PLACE.get_or_init(|| Scratch::new().unwrap()).path());
    let name = format!("{:?}.state", std::thread::current().id());
    folder.write_checkpoint(&name, content).unwrap();
    assert_eq!(folder.read_checkpoint(&name).unwrap().as_deref(), Some(content));
    let path = folder.checkpoint_path(&name);
    let mut file = std::fs::read(&path).unwrap();
    let at =
        content.iter().fold(content.len(), |sum, byte| sum * 31 % 65_521 + usize::from(*byte)) % file.len();
    file[at] ^= 1 << (at % 8);
    std::fs::write(&path, file).unwrap();
    assert!(matches!(folder.read_checkpoint(&name), Err(RunError::Damaged { .. })));
}

fn small(entry: &Entry) -> Box<dyn Estimator> {
    let known = |key: &str| entry.fields.iter().any(|field| field.key == key);
    let keys = SMALL.iter().filter(|(key, _)| known(key)).map(|(key, value)| format!("{key} = {value}\n"));
    let text = format!("[estimator]\n{}max_steps = {MOST_STEPS}\n", keys.collect::<String>());
    let document = Document::parse("small.toml", &text).unwrap();
    let section = [Section { name: "estimator", fields: entry.fields }];
    (entry.build)(&Resolved::new(&document, &section).unwrap()).unwrap()
}

/// Resumes from a state and returns the states stored on the way; `None` if the state was refused.
fn go_on(estimator: &dyn Estimator, state: &[u8]) -> Option<Vec<Vec<u8>>> {
    let times: Vec<f64> = (0..6).map(f64::from).collect();
    let logs = times.iter().map(|time| -0.1 * time - 0.01 * (time % 2.0)).collect();
    let envelope = Envelope::new(times, logs, 10.0).unwrap();
    let place = Place { latest: state, kept: RefCell::default() };
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&place);
    match estimator.fit(&envelope, &context) {
        Err(FitError::Checkpoint { problem }) => {
            assert!(place.kept.borrow().is_empty(), "refused after it was taken: {problem}");
            None
        }
        // The numbers are arbitrary: if they lead to a loss that is not finite, the fit reports that.
        Err(_) => Some(place.kept.into_inner()),
        Ok(estimate) => {
            assert!(estimate.steps <= MOST_STEPS, "{} steps of {MOST_STEPS}", estimate.steps);
            Some(place.kept.into_inner())
        }
    }
}
