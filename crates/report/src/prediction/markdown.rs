//! Tables of a study of held-out prediction as GitHub Markdown.

use results::{PredictionResult, ProblemOutcome, ProblemRow};

use super::scores;
use super::scores::READING;
use super::study::{facts, headline, held_out, laws, origin};
use crate::comparison::markdown::{escape, grid, list};
use crate::tables::ScoreTable;
use crate::verdict;

pub(crate) fn markdown(result: &PredictionResult) -> String {
    let (origin, verdict) = (origin(result), headline(result));
    let mut blocks = vec![
        "# Methods scored on peaks they did not see".to_owned(),
        format!("**{}.** {}", origin.label, origin.note),
        format!("**{}.** {}", verdict.label, escape(&verdict.sentence)),
        escape(&held_out(&result.splits)),
    ];
    blocks.extend(READING.iter().map(|sentence| escape(sentence)));
    for row in &result.problems {
        blocks.extend(problem(row));
    }
    blocks.join("\n\n") + "\n"
}

fn problem(row: &ProblemRow) -> Vec<String> {
    let origin = verdict::origin(row.origin);
    let mut blocks =
        vec![format!("## {}", escape(&row.title)), format!("**{}.** {}", origin.label, origin.note)];
    match &row.outcome {
        ProblemOutcome::Absent { reason } => blocks.push(format!("**ABSENT.** {}", escape(reason))),
        ProblemOutcome::Studied(study) => {
            let facts = facts(study);
            blocks.push(list(facts.iter().map(|fact| format!("{}: {}", fact.name, escape(&fact.value)))));
            blocks.extend(study.verdict.iter().map(|sentence| escape(sentence)));
            blocks.push(table(&scores::table(study)));
            let laws = laws(study);
            if !laws.is_empty() {
                blocks.push("Laws discovered:".to_owned());
                blocks.push(list(laws.iter().map(|law| escape(law))));
            }
        }
    }
    blocks
}

fn table(table: &ScoreTable) -> String {
    let columns: Vec<(&str, bool)> =
        table.columns.iter().enumerate().map(|(index, title)| (title.as_str(), index > 0)).collect();
    let rows = table.rows.iter().map(|row| {
        let title = escape(&row.title);
        let mut cells = vec![if row.is_marked { format!("**{title}**") } else { title }];
        if row.cells.is_empty() {
            cells.push(escape(&row.reason));
        }
        cells.extend(row.cells.iter().map(|cell| escape(cell)));
        cells.resize(columns.len(), String::new());
        cells
    });
    grid(&columns, rows)
}
