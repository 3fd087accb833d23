//! The options that every command takes, accepted without effect, and left out of the help, where a command has nothing for one to
//! act on.

use clap::{Arg, ArgAction, Command, value_parser};

/// An option and the name of its value.
type Idle = (&'static str, Option<&'static str>);

const OPTIONS: [Idle; 6] = [
    ("out", Some("DIR")),
    ("seed", Some("N")),
    ("threads", Some("N")),
    ("quiet", None),
    ("json", None),
    ("resume", None),
];

/// The command line with every option on every command, so that a script may pass them without asking which.
pub(crate) fn everywhere(command: Command) -> Command {
    command.mut_subcommands(|command| {
        let missing = OPTIONS
            .into_iter()
            .filter(|(name, ..)| command.get_arguments().all(|known| known.get_long() != Some(name)));
        let idle: Vec<Arg> = missing.map(idle).collect();
        command.args(idle)
    })
}

fn idle((name, value): Idle) -> Arg {
    let option = Arg::new(name).long(name).hide(true);
    match value {
        None => option.action(ArgAction::SetTrue),
        // Held to what the same option takes elsewhere.
        Some("N") => option.value_name("N").value_parser(value_parser!(u64)),
        Some(value) => option.value_name(value),
    }
}
