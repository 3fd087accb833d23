//! Glossary of a page: definitions of its terms, and a link to each definition from the first use of the
//! term.

/// A term and its definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Term {
    /// Term at the head of its definition.
    pub name: &'static str,
    /// Spellings to search for in a text, the longest first, ignoring case.
    pub spellings: &'static [&'static str],
    /// Definition in one or two sentences.
    pub definition: &'static str,
}

/// All defined terms, in alphabetical order.
pub const TERMS: &[Term] = &[
    Term {
        name: "× noise",
        spellings: &["× noise"],
        definition: "Size in units of the noise. For an error: its root mean square divided by the noise \
                     floor, so that 1 is the error of a perfect simulator. For a difference between two \
                     fits: over all samples together, so that about 3 is distinguishable from zero.",
    },
    Term {
        name: "Backbone curve",
        spellings: &["backbone curves", "backbone curve"],
        definition: "Frequency of free vibration against amplitude. Flat for a linear spring, rising where the spring \
                     stiffens, falling where it softens.",
    },
    Term {
        name: "Calibration error",
        spellings: &["calibration error"],
        definition: "Mean distance between stated probabilities and the frequency with which they come true. \
                     Scatter alone makes it larger than zero.",
    },
    Term {
        name: "Ceiling",
        spellings: &["ceiling"],
        definition: "Error that remains when a free, smooth torque is fitted on top of the repaired simulator: no \
                     further effect in the equation of motion could do better.",
    },
    Term {
        name: "Clock",
        spellings: &["host clock", "uniform-index clock"],
        definition: "Source of a sample’s time. The host clock is the time stamp in the file, which may be \
                     the time of arrival; the uniform-index clock counts samples and assumes that they are \
                     evenly spaced.",
    },
    Term {
        name: "Closure",
        spellings: &["closure"],
        definition: "Share of the gap that a repair removes: 1 − (squared error above the noise after) / (squared error \
                     above the noise before).",
    },
    Term {
        name: "Condition number",
        spellings: &["condition number"],
        definition: "Factor by which a fit can enlarge relative errors of its data, rounding included.",
    },
    Term {
        name: "Coulomb friction",
        spellings: &["Coulomb friction", "dry friction"],
        definition: "Friction of constant size that opposes the motion; a free swing under it loses the same amplitude in \
                     each period and comes to rest.",
    },
    Term {
        name: "Damping ratio ζ",
        spellings: &["damping ratio"],
        definition: "Damping as a share of critical damping: ζ = λ/√(λ² + ω²), near λ/ω where it is small. A free swing loses about the share 2πζ of its \
                     amplitude in each period.",
    },
    Term {
        name: "Decay rate λ",
        spellings: &["decay rate"],
        definition: "Rate of the exponential decay of the amplitude, A(t) = A₀ exp(−λt), in 1/s.",
    },
    Term {
        name: "Discrepancy",
        spellings: &["discrepancy", "sim-to-real gap"],
        definition: "Difference between what a simulator predicts and what was recorded, beyond the noise.",
    },
    Term {
        name: "Envelope",
        spellings: &["envelope"],
        definition: "Amplitudes of the peaks of a record over time; the damping ratio is read from their decay.",
    },
    Term {
        name: "Held-out",
        spellings: &["held-out", "held out"],
        definition: "Data that a fit did not see, kept back to test it.",
    },
    Term {
        name: "Interval, 95 %",
        spellings: &["95 % intervals", "95 % interval"],
        definition: "Range that holds the true value in 95 of 100 repetitions, as far as the assumptions stated beside it \
                     hold.",
    },
    Term {
        name: "Noise floor",
        spellings: &["noise floor"],
        definition: "Standard deviation of the measurement noise: the error that no simulator can go below.",
    },
    Term {
        name: "Phase plane",
        spellings: &["phase plane"],
        definition: "Velocity plotted against position. A decaying swing is a spiral into its middle.",
    },
    Term {
        name: "Pipeline",
        spellings: &["pipeline"],
        definition: "Steps from a record to its envelope: smoothing, interpolation, finding of peaks.",
    },
    Term {
        name: "Recalibrated",
        spellings: &["recalibrated", "recalibration"],
        definition: "Said of the given simulator if its own coefficients are fitted to the record and no \
                     effect is added.",
    },
    Term {
        name: "Reference (least squares)",
        spellings: &["closed-form least squares", "certified least squares", "reference (least squares)"],
        definition: "Closed-form least-squares fit of a line to the logarithm of the amplitude, computed in \
                     extended precision. Every other method is compared with it. It is exact for the fit, \
                     not for the oscillator.",
    },
    Term {
        name: "Residual",
        spellings: &["residuals", "residual"],
        definition: "Measured value less the fitted one.",
    },
    Term {
        name: "Restoring force",
        spellings: &["restoring-force surface", "restoring force"],
        definition: "Force that drives an oscillator back to rest, as a function of position and velocity. Of a linear \
                     oscillator its surface is a plane.",
    },
    Term {
        name: "Shapley value",
        spellings: &["Shapley value"],
        definition: "Fair share of a joint result: a part’s contribution, averaged over all orders in which the parts can \
                     be added.",
    },
    Term {
        name: "Stability",
        spellings: &["stability"],
        definition: "Share of the bootstrap draws of a record’s segments in which a class of effects is \
                     better supported than the effects that replace it.",
    },
    Term {
        name: "Standard error",
        spellings: &["standard errors", "standard error"],
        definition: "Standard deviation that an estimate would have in repetitions of the measurement.",
    },
];

/// Elements whose text stays unchanged: code, plots, headings, and elements that already react to a click.
const SKIPPED: [&str; 12] = [
    "script",
    "style",
    "svg",
    "pre",
    "code",
    "a",
    "h1",
    "h2",
    "h3",
    "thead",
    "summary",
    "ul class=\"legend\"",
];

/// Returns the page with a link from the first use of each term to its definition, and with the definitions
/// at `place`, a mark in the page. Text in a page is escaped, so every tag comes from the templates.
pub(crate) fn explained(html: &str, place: &str) -> String {
    let mut page = String::with_capacity(html.len() + 8_000);
    let mut used: Vec<&Term> = Vec::new();
    let mut rest = html;
    let mut inside_body = false;
    while let Some(at) = rest.find('<') {
        let (text, tag) = rest.split_at(at);
        page.push_str(&if inside_body { linked(text, &mut used) } else { text.to_owned() });
        let skipped = SKIPPED.iter().find(|name| opens(tag, name));
        let end = match skipped {
            Some(name) => {
                let closing = format!("</{}>", name.split(' ').next().unwrap_or(name));
                tag.find(&closing).map(|at| at + closing.len())
            }
            None => tag.find('>').map(|at| at + 1),
        };
        let (element, after) = tag.split_at(end.unwrap_or(tag.len()));
        inside_body |= opens(element, "body");
        page.push_str(element);
        rest = after;
    }
    page.push_str(rest);
    used.sort_by_key(|term| TERMS.iter().position(|other| other == *term));
    page.replacen(place, &section(&used), 1)
}

fn opens(tag: &str, name: &str) -> bool {
    let rest = tag.strip_prefix('<').and_then(|tag| tag.strip_prefix(name));
    rest.is_some_and(|rest| rest.starts_with(['>', ' ', '\n']))
}

/// Returns a text in which the first use of each term not in `used` is a link.
fn linked(text: &str, used: &mut Vec<&Term>) -> String {
    let first = TERMS
        .iter()
        .filter(|term| !used.contains(term))
        .filter_map(|term| {
            let found =
                term.spellings.iter().filter_map(|words| find(text, words).map(|at| (at, words.len())));
            found.min_by_key(|(at, length)| (*at, usize::MAX - length)).map(|(at, length)| (at, length, term))
        })
        .min_by_key(|(at, length, _)| (*at, usize::MAX - length));
    let Some((at, length, term)) = first else { return text.to_owned() };
    used.push(term);
    let (before, from) = text.split_at(at);
    let (words, after) = from.split_at(length);
    let (id, definition) = (anchor(term), term.definition);
    let link = format!("<a class=\"term\" href=\"#{id}\" title=\"{definition}\">{words}</a>");
    format!("{before}{link}{}", linked(after, used))
}

/// Returns the position of words that stand by themselves in a text, ignoring case.
fn find(text: &str, words: &str) -> Option<usize> {
    let is_letter =
        |letter: Option<char>| letter.is_some_and(|letter| letter.is_alphanumeric() || letter == '-');
    text.char_indices().map(|(at, _)| at).find(|at| {
        let found = text.get(*at..*at + words.len()).is_some_and(|part| part.eq_ignore_ascii_case(words));
        let (before, after) = (text.get(..*at), text.get(*at + words.len()..));
        found
            && !is_letter(before.and_then(|before| before.chars().next_back()))
            && !is_letter(after.and_then(|after| after.chars().next()))
    })
}

fn anchor(term: &Term) -> String {
    let letters = term.name.chars().filter_map(|letter| match letter {
        ' ' | '-' => Some('-'),
        letter if letter.is_ascii_alphanumeric() => Some(letter.to_ascii_lowercase()),
        _ => None,
    });
    format!("term-{}", letters.collect::<String>().trim_matches('-'))
}

fn section(used: &[&Term]) -> String {
    if used.is_empty() {
        return String::new();
    }
    let items: String = used
        .iter()
        .map(|term| {
            format!(
                "    <div id=\"{}\"><dt>{}</dt><dd>{}</dd></div>\n",
                anchor(term),
                term.name,
                term.definition
            )
        })
        .collect();
    format!(
        "<section aria-labelledby=\"glossary\">\n  <h2 id=\"glossary\">Terms on this page</h2>\n  <dl class=\"data terms\">\n{items}  </dl>\n</section>"
    )
}

/// Returns a page without the links to its terms, so that tests can read its sentences as a whole.
#[cfg(test)]
pub(crate) fn unexplained(html: &str) -> String {
    let mut parts = html.split("<a class=\"term\"");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (words, rest) = part.split_once('>').unwrap().1.split_once("</a>").unwrap();
        plain.push_str(words);
        plain.push_str(rest);
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: &str = "<!-- terms -->";

    #[test]
    fn the_first_place_of_a_term_is_a_link_to_its_definition() {
        let html = format!("<body><p>A Damping ratio, a damping ratio.</p><p>decay rate</p>{PLACE}</body>");
        let page = explained(&html, PLACE);
        assert_eq!(page.matches("href=\"#term-damping-ratio\"").count(), 1);
        assert!(page.contains(">Damping ratio</a>, a damping ratio."));
        assert!(page.contains("<div id=\"term-damping-ratio\"><dt>Damping ratio ζ</dt>"));
        assert!(page.contains(">decay rate</a>") && !page.contains("term-envelope"));
    }

    #[test]
    fn code_headings_plots_and_parts_of_words_stay_as_they_are() {
        let html = "<title>envelope</title><body><h2 id=\"x\">Envelope</h2><pre>envelope</pre><code>envelope</code>\
                    <svg><text>envelope</text></svg><p>envelopes, re-envelope</p></body>";
        assert_eq!(explained(html, PLACE), html);
    }

    #[test]
    fn terms_have_anchors_of_their_own_and_plain_definitions() {
        let mut anchors: Vec<String> = TERMS.iter().map(anchor).collect();
        anchors.sort();
        anchors.dedup();
        assert_eq!(anchors.len(), TERMS.len());
        for term in TERMS {
            assert!(term.definition.ends_with('.') && !term.definition.contains(['<', '>', '"', '&']));
            assert!(anchor(term).len() > "term-".len());
        }
    }

    #[test]
    fn names_keep_alphabetical_order() {
        let names: Vec<String> = TERMS.iter().skip(1).map(|term| term.name.to_lowercase()).collect();
        assert!(names.is_sorted(), "{names:?}");
    }
}
