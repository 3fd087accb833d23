//! Tables as LaTeX with the rules of the package booktabs.

/// First lines of a file of tables.
pub(crate) const PREAMBLE: &str =
    "% Needs \\usepackage{booktabs}; wide tables also fit with \\resizebox or \\small.\n";

/// Returns a table environment; each column is a title and `true` for right alignment.
pub(crate) fn table(
    caption: &str,
    columns: &[(&str, bool)],
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
    let align: String = columns.iter().map(|(_, right)| if *right { 'r' } else { 'l' }).collect();
    let titles = columns.iter().map(|(title, _)| escape(title)).collect();
    let body: String = rows.map(|row| line(row.iter().map(|cell| escape(cell)).collect())).collect();
    format!(
        "\\begin{{table}}\n\\centering\n\\caption{{{}}}\n\\begin{{tabular}}{{{align}}}\n\\toprule\n{}\\midrule\n{body}\
         \\bottomrule\n\\end{{tabular}}\n\\end{{table}}\n",
        escape(caption),
        line(titles)
    )
}

/// Escapes text so that LaTeX shows it literally; the symbols of the report become commands that every engine
/// knows.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut raised = String::new();
    for letter in text.chars() {
        if let Some(digit) = superscript(letter) {
            raised.push(digit);
            continue;
        }
        raise(&mut escaped, &mut raised);
        match symbol(letter) {
            Some(command) => escaped.push_str(command),
            None if letter.is_control() => escaped.push(' '),
            None => escaped.push(letter),
        }
    }
    raise(&mut escaped, &mut raised);
    escaped
}

/// Moves collected superscripts into the text.
fn raise(escaped: &mut String, raised: &mut String) {
    if !raised.is_empty() {
        escaped.push_str(&format!("$^{{{raised}}}$"));
        raised.clear();
    }
}

fn superscript(letter: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"
        .chars()
        .zip("0123456789-".chars())
        .find(|(raised, _)| *raised == letter)
        .map(|(_, digit)| digit)
}

fn symbol(letter: char) -> Option<&'static str> {
    Some(match letter {
        '\\' => "\\textbackslash{}",
        '~' => "\\textasciitilde{}",
        '^' => "\\textasciicircum{}",
        '{' => "\\{",
        '}' => "\\}",
        '$' => "\\$",
        '&' => "\\&",
        '#' => "\\#",
        '%' => "\\%",
        '_' => "\\_",
        '<' => "$<$",
        '>' => "$>$",
        '|' => "$|$",
        '[' => "{[}",
        ']' => "{]}",
        'ζ' => "$\\zeta$",
        'λ' => "$\\lambda$",
        'ω' => "$\\omega$",
        'µ' | 'μ' => "$\\mu$",
        '±' => "$\\pm$",
        '×' => "$\\times$",
        '\u{2212}' => "$-$",
        '\u{a0}' => "~",
        '\u{202f}' => "\\,",
        '₀' => "$_0$",
        '–' => "--",
        '…' => "\\ldots{}",
        '’' => "'",
        '“' => "``",
        '"' | '”' => "''",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{escape, table};

    #[test]
    fn special_letters_are_shown_and_symbols_are_commands() {
        assert_eq!(escape("a_b & 5 % {x}\\"), "a\\_b \\& 5 \\% \\{x\\}\\textbackslash{}");
        assert_eq!(escape("ζ = 3.1\u{a0}×\u{a0}10⁻⁷"), "$\\zeta$ = 3.1~$\\times$~10$^{-7}$");
        assert_eq!(escape("a\nb [64] µs"), "a b {[}64{]} $\\mu$s");
    }

    #[test]
    fn a_table_has_the_rules_of_booktabs() {
        let text =
            table("a_b", &[("method", false), ("ζ", true)], [vec!["x".into(), "1".into()]].into_iter());
        assert_eq!(
            text,
            "\\begin{table}\n\\centering\n\\caption{a\\_b}\n\\begin{tabular}{lr}\n\\toprule\nmethod & $\\zeta$ \\\\\n\
             \\midrule\nx & 1 \\\\\n\\bottomrule\n\\end{tabular}\n\\end{table}\n"
        );
    }
}
