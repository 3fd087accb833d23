//! Common options on every command. A command for which an option has no meaning accepts it without effect
//! and does not show it in its help.

use clap::{Arg, ArgAction, Command, value_parser};

/// Option without effect and the name of its value.
type Idle = (&'static str, Option<&'static str>);

const OPTIONS: [Idle; 6] = [
    ("out", Some("DIR")),
    ("seed", Some("N")),
    ("threads", Some("N")),
    ("quiet", None),
    ("json", None),
    ("resume", None),
];

/// Adds all common options to every command, so that a script may pass them to any of them.
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
        // A number, as for the same option elsewhere.
        Some("N") => option.value_name("N").value_parser(value_parser!(u64)),
        Some(value) => option.value_name(value),
    }
}
