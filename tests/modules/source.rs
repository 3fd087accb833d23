//! Text of a Rust source file for scanning: without comments, literals and tests.

/// Replaces comments, strings and characters by blanks; line breaks stay.
pub(super) fn code_only(text: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let mut code = String::with_capacity(text.len());
    let mut at = 0;
    while at < letters.len() {
        let end = end_of_blank(&letters, at).unwrap_or(at);
        if end == at {
            code.push(letters[at]);
            at += 1;
            continue;
        }
        code.extend(letters[at..end].iter().map(|&letter| if letter == '\n' { '\n' } else { ' ' }));
        at = end;
    }
    code
}

/// Returns the end of a comment or a literal that starts here; `None` if none does.
fn end_of_blank(letters: &[char], at: usize) -> Option<usize> {
    let starts = |pattern: &str| pattern.chars().enumerate().all(|(n, c)| letters.get(at + n) == Some(&c));
    let within_name = at > 0 && (letters[at - 1].is_alphanumeric() || letters[at - 1] == '_');
    if starts("//") {
        return Some((at..letters.len()).find(|&n| letters[n] == '\n').unwrap_or(letters.len()));
    }
    if starts("/*") {
        let close =
            (at + 2..letters.len()).find(|&n| letters[n - 1] == '*' && letters[n] == '/' && n > at + 2);
        return Some(close.map_or(letters.len(), |n| n + 1));
    }
    if starts("\"") {
        return Some(after_quote(letters, at + 1, '"'));
    }
    if !within_name && (starts("r\"") || starts("r#") || starts("br\"") || starts("br#")) {
        return after_raw(letters, at);
    }
    // A character literal and not a lifetime.
    if starts("'") && (letters.get(at + 1) == Some(&'\\') || letters.get(at + 2) == Some(&'\'')) {
        let escaped = usize::from(letters.get(at + 1) == Some(&'\\'));
        return Some(after_quote(letters, at + 1 + 2 * escaped, '\''));
    }
    None
}

fn after_quote(letters: &[char], mut at: usize, quote: char) -> usize {
    while at < letters.len() && letters[at] != quote {
        at += 1 + usize::from(letters[at] == '\\');
    }
    (at + 1).min(letters.len())
}

/// Returns the end of a raw string; `None` for a raw identifier.
fn after_raw(letters: &[char], at: usize) -> Option<usize> {
    let first = at + usize::from(letters[at] == 'b') + 1;
    let hashes = letters[first..].iter().take_while(|&&letter| letter == '#').count();
    if letters.get(first + hashes) != Some(&'"') {
        return None;
    }
    let close = |&n: &usize| {
        letters[n] == '"'
            && letters[n + 1..].iter().take(hashes).filter(|&&letter| letter == '#').count() == hashes
    };
    let quote = (first + hashes + 1..letters.len()).find(close)?;
    Some(quote + 1 + hashes)
}

/// Replaces every item under `#[cfg(test)]` by blanks.
pub(super) fn without_tests(code: &str) -> String {
    let mut kept = code.to_owned();
    while let Some(start) = kept.find("#[cfg(test)]") {
        let end = end_of_item(&kept, start + "#[cfg(test)]".len());
        let blank: String = kept[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        kept.replace_range(start..end, &blank);
    }
    kept
}

/// Returns the end of the item that starts here: after its `;` or its block.
fn end_of_item(code: &str, from: usize) -> usize {
    let mut depth = 0_usize;
    for (at, letter) in code[from..].char_indices() {
        match letter {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => {
                depth = depth.saturating_sub(1);
                if letter == '}' && depth == 0 {
                    return from + at + 1;
                }
            }
            ';' if depth == 0 => return from + at + 1,
            _ => {}
        }
    }
    code.len()
}

/// Returns functions with the number of lines from `fn` to the closing brace.
pub(super) fn functions(code: &str) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let before = code[..at].chars().next_back();
        let name: String =
            code[at + 3..].chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect();
        if name.is_empty() || before.is_some_and(|letter| letter.is_alphanumeric() || letter == '_') {
            continue;
        }
        let end = end_of_item(code, at);
        found.push((name, code[at..end].lines().count()));
    }
    found
}
