//! Tables of oscilloscopes: Rigol's, whose second line states start and increment of the time, and
//! Tektronix', whose facts stand in columns of their own beside the first samples.

use crate::text::text_of;

/// Returns the table of an oscilloscope's export as plain text; `None` for other files.
pub(super) fn text(bytes: &[u8]) -> Option<String> {
    let is_scope = bytes.starts_with(b"X,CH") || bytes.starts_with(b"Record Length,");
    let text = text_of(bytes).ok().filter(|_| is_scope)?;
    rigol(&text).or_else(|| tektronix(&text))
}

/// Returns the table of Rigol's lines `X,CH1,Start,Increment`, `Sequence,Volt,-2.19,9.6e-3`, `0,0.316`.
fn rigol(text: &str) -> Option<String> {
    let mut lines = text.lines().map(|line| line.trim().trim_end_matches(',').split(',').collect::<Vec<_>>());
    let (names, facts) = (lines.next()?, lines.next()?);
    let channels = names.iter().position(|name| *name == "Start").filter(|_| names.first() == Some(&"X"))?;
    let number = |cells: &[&str], at: usize| cells.get(at).and_then(|cell| cell.trim().parse::<f64>().ok());
    let (start, increment) = (number(&facts, channels)?, number(&facts, channels + 1)?);
    let titles: Vec<String> = (1..channels)
        .filter_map(|at| Some(format!(",{} ({})", names.get(at)?, facts.get(at)?.replace("Volt", "V"))))
        .collect();
    let mut table = format!("time_s{}\n", titles.concat());
    for cells in lines {
        let Some(index) = number(&cells, 0) else { continue };
        // A line of an index alone has no values.
        let values = cells.get(1..channels.min(cells.len())).unwrap_or(&[]);
        table.push_str(&format!("{},{}\n", start + index * increment, values.join(",")));
    }
    Some(table)
}

/// Returns the table in the last two columns that hold numbers; the columns before them hold facts, among
/// them the channel (`Source`) and its unit (`Vertical Units`).
fn tektronix(text: &str) -> Option<String> {
    let rows = || text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
    let fact = |name: &str| {
        let mut found = rows().filter(|cells| cells.first() == Some(&name));
        found.find_map(|cells| cells.get(1).map(|cell| (*cell).to_owned())).filter(|cell| !cell.is_empty())
    };
    let pair = |cells: &[&str]| -> Option<[String; 2]> {
        let filled: Vec<&&str> = cells.iter().skip(2).filter(|cell| !cell.is_empty()).collect();
        let [.., time, value] = filled.as_slice() else { return None };
        (time.parse::<f64>().is_ok() && value.parse::<f64>().is_ok())
            .then(|| [(**time).to_owned(), (**value).to_owned()])
    };
    let samples: Vec<[String; 2]> = rows().filter_map(|cells| pair(&cells)).collect();
    let channel = fact("Source").unwrap_or_else(|| "value".to_owned());
    let unit = fact("Vertical Units").map_or_else(String::new, |unit| format!(" ({unit})"));
    let table = samples
        .iter()
        .fold(format!("time_s,{channel}{unit}\n"), |text, [time, value]| text + time + "," + value + "\n");
    (!samples.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::text;

    #[test]
    fn both_tables_become_times_and_values() {
        let rigol = "X,CH1,Start,Increment,\nSequence,Volt,-2.0,0.5,\n0,0.25,\n1,-0.5,\n";
        assert_eq!(text(rigol.as_bytes()).unwrap(), "time_s,CH1 (V)\n-2,0.25\n-1.5,-0.5\n");
        let tektronix =
            "Record Length,2500,,-0.5,0.1,\nSource,CH1,,-0.4,0.2,\nVertical Units,V,,-0.3,0.1,\n,,,-0.2,0,\n";
        let table = "time_s,CH1 (V)\n-0.5,0.1\n-0.4,0.2\n-0.3,0.1\n-0.2,0\n";
        assert_eq!(text(tektronix.as_bytes()).unwrap(), table);
        assert_eq!(text(b"time,angle\n0,1\n"), None);
        assert_eq!(text(b"Record Length,2500\n"), None);
    }
}
