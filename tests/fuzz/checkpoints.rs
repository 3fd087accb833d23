//! Fits that go on from anything: shared by the fuzzer and by the test that replays what it found.
//!
//! What is fed is sealed as a checkpoint first, so that the fuzzer gets past the digest, to who reads what is
//! behind it. A fit either refuses a state or goes on from exactly that one, within its budget; and one
//! flipped bit of the sealed file is noticed, whatever it holds.

use envelope::Envelope;
use estimator::{Cancel, Checkpoints, Entry, Estimator, FitContext, FitError, Silent};
use runs::{RunError, RunFolder, Scratch};
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;
use std::sync::OnceLock;

/// Steps that a fit may take in all.
const MOST_STEPS: u64 = 3;

/// The smallest of everything that has a size; an estimator takes of these what it declares.
const SMALL: [(&str, &str); 7] = [
    ("hidden", "[2]"),
    ("collocation_points", "2"),
    ("hidden_units", "1"),
    ("longest_sequence", "4"),
    ("batch", "2"),
    ("calibration", "0"),
    ("peaks", "[5, 8]"),
];

/// A state to begin from, and the states that are kept meanwhile.
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

/// The state of a fit in progress: which of the estimators is asked for in the first byte, the state in the others.
pub(crate) fn checkpoint(data: &[u8], estimators: &[Entry]) {
    let Some((first, state)) = data.split_first() else { return };
    sealed(state);
    let estimator = small(&estimators[usize::from(*first) % estimators.len()]);
    let Some(kept) = go_on(&*estimator, state) else { return };
    // One state may be written in more than one way, what a fit writes is written in one.
    let [first, ..] = &kept[..] else { panic!("a fit that goes on keeps what it goes on from") };
    assert_eq!(go_on(&*estimator, first).as_ref(), Some(&kept), "the same state, another way on");
}

/// What is sealed comes back, and with a bit flipped it does not.
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

/// Goes on from a state: what was kept on the way, or `None` where it was refused.
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
        // The numbers may be any: where they lead to no finite loss, that is what the fit says.
        Err(_) => Some(place.kept.into_inner()),
        Ok(estimate) => {
            assert!(estimate.steps <= MOST_STEPS, "{} steps of {MOST_STEPS}", estimate.steps);
            Some(place.kept.into_inner())
        }
    }
}
