//! The options that every command takes, added where a command has nothing for one to act on.

use clap::{Arg, ArgAction, Command, value_parser};

/// An option, the name of its value, and what its help says where nothing is done with it.
type Idle = (&'static str, Option<&'static str>, &'static str);

const OPTIONS: [Idle; 6] = [
    ("out", Some("DIR"), "No effect here: there is no folder to choose"),
    ("seed", Some("N"), "No effect here: nothing new is drawn"),
    ("threads", Some("N"), "No effect here: one thread is enough"),
    ("quiet", None, "No effect here: all that is printed is the result"),
    ("json", None, "No effect here: the result is JSON already"),
    ("resume", None, "No effect here: there is nothing to go on with"),
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

fn idle((name, value, help): Idle) -> Arg {
    let option = Arg::new(name).long(name).help(help);
    match value {
        None => option.action(ArgAction::SetTrue),
        // Held to what the same option takes elsewhere.
        Some("N") => option.value_name("N").value_parser(value_parser!(u64)),
        Some(value) => option.value_name(value),
    }
}
