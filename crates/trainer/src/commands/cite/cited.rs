//! Entries of `literature.bib` that the short citations of methods and effects mean.

/// Bibliography with one entry for each work, sorted by key; entries are separated by blank lines.
const LITERATURE: &str = include_str!("literature.bib");

/// Citations whose works do not follow from the first author and the year, and the keys of these works.
const CITED: &[(&str, &[&str])] = &[
    (
        "Feldman, Hilbert Transform Applications in Mechanical Vibration, Wiley 2011, chapter 9",
        &["feldman2011applications"],
    ),
    ("Feldman, Mechanical Systems and Signal Processing 25 (2011) 735-802", &["feldman2011hilbert"]),
    ("NumPy reference, numpy.polyfit", &["numpypolyfit"]),
    (
        "Wen, Journal of the Engineering Mechanics Division 102 (1976) 249; with γ = 0 and n = 1 Dahl, Aerospace Corporation TOR-0158(3107-18)-1 (1968), exponent 1",
        &["wen1976", "dahl1968"],
    ),
];

/// Keys of the works that every diagnosis follows, whatever it finds: on the fits, the effective size of
/// correlated samples, and the choice of the named effects.
pub(super) const DIAGNOSIS: &[&str] = &["barbieri2004", "geyer1992", "marquardt1963"];

/// Returns the keys and entries of the bibliography.
pub(super) fn entries() -> Vec<(&'static str, &'static str)> {
    let key = |entry: &'static str| Some(entry.split_once('{')?.1.split_once(',')?.0);
    LITERATURE.split("\n\n").filter_map(|entry| Some((key(entry)?, entry.trim()))).collect()
}

/// Returns the keys of the works that a citation means: the listed ones, or the work whose key is the surname of
/// the first author and a year that the citation names.
pub(super) fn keys(citation: &str) -> Vec<&'static str> {
    if let Some((_, keys)) = CITED.iter().find(|(text, _)| *text == citation) {
        return keys.to_vec();
    }
    let author: String = citation.chars().flat_map(char::to_lowercase).filter_map(plain).collect();
    let is_meant = |key: &str| {
        key.split_at_checked(key.len().wrapping_sub(4)).is_some_and(|(name, year)| {
            !name.is_empty() && author.starts_with(name) && citation.contains(year)
        })
    };
    entries().into_iter().map(|(key, _)| key).filter(|key| is_meant(key)).collect()
}

/// Returns a lowercase letter without its accent; `None` for other characters.
fn plain(letter: char) -> Option<char> {
    Some(match letter {
        'a'..='z' => letter,
        'á' | 'ä' | 'å' => 'a',
        'ć' | 'č' => 'c',
        'é' | 'è' => 'e',
        'ó' | 'ö' => 'o',
        'š' => 's',
        'ú' | 'ü' => 'u',
        _ => return None,
    })
}
