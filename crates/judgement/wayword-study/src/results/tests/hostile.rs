use super::super::escape;
use super::{
    figures::of,
    fixtures::small,
    reader::{column, read},
};
use crate::{StudyTask, wording::RATE_QUESTIONS};

fn hostile() -> Vec<String> {
    let texts = [
        "<script>alert(1)</script>",
        "</style></title><img src=x onerror=alert(1)>",
        "=cmd|' /C calc'!A0",
        "+1+1",
        "-2+3",
        "@SUM(A1)",
        "\t=1+1",
        "\r=1+1",
        "  =1+1",
        "＝1+1",
        "\0=1+1",
        "'=1+1",
        "\\input{/etc/passwd} \\write18{id} $x$ %",
        "| a | b |\n|---|---|\n# heading\n[x](javascript:alert(1)) ![x](http://a/b.png)",
        "\u{202e}txt.exe\u{2066}",
        "a\u{0}b\u{1b}[31mred\u{7}",
        "line one\r\nline two\rline three, \"quoted\"; \u{2028}",
        "{{ 7 * 7 }}{% include '/etc/passwd' %}",
    ];
    texts.into_iter().map(str::to_owned).chain(["x".repeat(10_000), String::new()]).collect()
}

#[test]
fn free_text_is_inert_in_every_file() {
    let texts = hostile();
    let mut data = small(StudyTask::Rate);
    for (slot, text) in data.slots.iter_mut().zip(texts.iter().cycle()) {
        slot.own_text = Some(text.clone());
    }
    let files = of(&data).render_files().unwrap();
    for (name, text) in &files {
        assert!(!text.contains(['\0', '\u{1b}', '\u{7}', '\u{202e}', '\u{2066}', '\u{2028}']), "{name}");
        if *name != "answers.csv" {
            assert!(texts.iter().filter(|one| one.len() > 6).all(|one| !text.contains(one.as_str())), "{name}");
            assert!(!text.contains("alert(1)"), "{name}: nobody's text is shown");
        }
    }
    let answers = &files.iter().find(|(name, _)| *name == "answers.csv").unwrap().1;
    for cell in column(&read(answers), "own_text") {
        let begins = cell.trim_start().chars().next();
        assert!(!begins.is_some_and(|c| "=+-@＝＋－＠".contains(c)), "{cell:?}");
        assert!(!cell.starts_with(['\t', '\r', '\n']), "{cell:?}");
    }
}

/// Names of conditions, routes, scenes and the title come from files that somebody else may have made.
#[test]
fn names_are_inert_in_every_file() {
    for (mode, text) in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair]
        .into_iter()
        .flat_map(|mode| hostile().into_iter().map(move |text| (mode, text)))
    {
        let mut data = small(mode);
        data.settings.title = text.clone();
        data.plan.style = text.clone();
        data.plan.conditions[0].source = text.clone();
        let old = std::mem::replace(&mut data.plan.conditions[0].name, format!("{text}x"));
        for told in data.items.iter_mut().flat_map(|item| &mut item.texts) {
            if told.condition == old {
                told.condition = format!("{text}x");
            }
            told.text = text.clone();
        }
        data.routes[0].name = text.clone();
        for (name, file) in of(&data).render_files().unwrap() {
            let is_markup = name.ends_with(".html") || name.ends_with(".md");
            assert!(
                !file.contains(['\0', '\u{1b}', '\u{7}', '\u{202e}', '\u{2066}', '\u{2028}']) || name == "results.json",
                "{name}"
            );
            if is_markup {
                for tag in ["<script", "<img", "</title><img", "</style></"] {
                    assert!(!file.contains(tag), "{name}: {tag} of {text:?}");
                }
                assert!(name.ends_with(".html") || !file.replace("\\]", "").contains("](javascript"), "{name}");
            }
            if name.ends_with(".tex") {
                for command in ["\\input", "\\write"] {
                    assert!(!file.contains(command), "{name}: {command}");
                }
                latex_is_whole(&file);
            }
            if name.ends_with(".csv") {
                let rows = read(&file);
                assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{name}");
            }
            if name == "results.md" {
                tables_are_whole(&file);
            }
        }
    }
}

/// Every line of a Markdown table has as many cells as its head.
fn tables_are_whole(markdown: &str) {
    let mut columns = None;
    for line in markdown.lines() {
        let cells = line.replace("\\|", "").matches('|').count();
        columns = match columns {
            _ if !line.starts_with('|') => None,
            None => Some(cells),
            Some(columns) => {
                assert_eq!(cells, columns, "{line}");
                Some(columns)
            }
        };
    }
}

/// Every row of a LaTeX table has as many cells as the table has columns, groups are closed, and no line runs into a comment.
fn latex_is_whole(latex: &str) {
    let mut columns = 0;
    let mut depth = 0i32;
    for line in latex.lines().filter(|line| !line.starts_with('%')) {
        let plain =
            line.replace("\\\\", "").replace("\\&", "").replace("\\%", "").replace("\\{", "").replace("\\}", "");
        depth += plain.matches('{').count() as i32 - plain.matches('}').count() as i32;
        assert!(!plain.contains('%'), "{line}");
        if let Some((_, format)) = line.split_once("\\begin{tabular}") {
            let format = format.replace("\\linewidth", "");
            columns = format.matches(['l', 'r', 'p']).count();
        } else if line.ends_with("\\\\") {
            assert_eq!(plain.matches('&').count() + 1, columns, "{line}");
        }
    }
    assert_eq!(depth, 0);
    assert_eq!(latex.matches("\\begin{").count(), latex.matches("\\end{").count());
}

#[test]
fn numbers_are_never_taken_for_formulas() {
    assert_eq!(escape::escape_csv_cell("-"), "\"'-\"");
    assert_eq!(escape::escape_csv_cell("plain"), "plain");
    assert_eq!(super::super::sheet::SheetCell::Number(-1.5, 1), super::super::sheet::SheetCell::number(Some(-1.5), 1));
    let mut sheet = super::super::sheet::DataSheet::new("x.csv", "x", vec![]);
    sheet.rows.push(vec![super::super::sheet::SheetCell::Number(-1.5, 1), super::super::sheet::SheetCell::Whole(-2)]);
    assert_eq!(sheet.to_csv(), "\r\n-1.5,-2\r\n");
}

#[test]
fn the_wording_is_printed_whole() {
    let files = of(&small(StudyTask::Rate)).render_files().unwrap();
    for name in ["index.html", "results.md", "results.tex", "results.json"] {
        let text = &files.iter().find(|(other, _)| *other == name).unwrap().1;
        for scale in RATE_QUESTIONS {
            assert!(text.contains(scale.text), "{name}: {}", scale.text);
            assert!(scale.levels.iter().all(|level| text.contains(level)), "{name}: {}", scale.name);
        }
    }
}
