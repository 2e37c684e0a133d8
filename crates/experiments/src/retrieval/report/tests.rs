use super::*;
use crate::retrieval::row::{Growth, Timing};

fn row(experiment: &str, planner: &str, scene_seed: u64, removed: usize, total: f64) -> Row {
    Row {
        experiment: experiment.to_owned(),
        planner: planner.to_owned(),
        objects: 12,
        first_limit: "1".to_owned(),
        scene_seed,
        status: "solved".to_owned(),
        verdict: "valid".to_owned(),
        removed,
        bound: 2,
        bound_kind: "grasps".to_owned(),
        samples: 100 * removed,
        iterations: 3,
        timing: Timing { total, task: 0.75 * total, motion: 0.25 * total, judged: 0.0 },
        version: "1, of \"two\"".to_owned(),
        ..Row::default()
    }
}

fn growing(nodes: &[(usize, usize)]) -> Row {
    let growth = nodes.iter().map(|n| Growth { roadmap_nodes: n.0, retrieval_nodes: n.1, ..Growth::default() });
    Row { growth: growth.collect(), ..row("graphs", "paper", 1, 2, 0.1) }
}

fn all_experiments() -> Vec<Row> {
    let failed = |row: Row| Row { status: "out_of_budget".to_owned(), verdict: "none".to_owned(), removed: 0, ..row };
    let exact = |seed, optimum| {
        let row = row("optimal", "exact", seed, optimum, 0.5);
        Row { optimum: Some(optimum), verdict: "none".to_owned(), ..row }
    };
    vec![
        row("known", "clearway", 1, 2, 0.010),
        row("known", "clearway", 2, 4, 0.030),
        failed(row("known", "clearway", 3, 0, 9.0)),
        Row { status: "refused".into(), verdict: "violations".into(), ..row("known", "a <b> & \"c\", d|", 1, 2, 0.1) },
        growing(&[(10, 5), (30, 6)]),
        growing(&[(20, 5)]),
        growing(&[]),
        row("peers", "clearway", 1, 2, 0.010),
        row("peers", "clearway", 2, 3, 0.020),
        row("peers", "clearway", 3, 9, 9.0),
        row("peers", "traversability", 1, 4, 0.020),
        row("peers", "traversability", 2, 4, 0.040),
        failed(row("peers", "traversability", 3, 0, 9.0)),
        Row { objects: 100, sequences: 7, ..row("large", "clearway", 1, 12, 2.5) },
        exact(1, 2),
        exact(2, 3),
        row("optimal", "brute_force", 1, 2, 5.0),
        row("optimal", "clearway", 1, 2, 0.010),
        row("optimal", "clearway", 1, 3, 0.010),
        row("optimal", "clearway", 1, 5, 0.010),
        row("optimal", "clearway", 1, 1, 0.010),
        row("optimal", "clearway", 2, 3, 0.010),
        Row { least_removals: 3, ..row("stacked", "streams", 1, 3, 0.040) },
        Row { least_removals: 3, ..row("stacked", "streams", 2, 4, 0.060) },
        failed(Row { least_removals: 3, ..row("stacked", "streams", 3, 0, 9.0) }),
    ]
}

fn file<'a>(report: &'a Report, name: &str) -> &'a str {
    &report.files.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no {name}")).1
}

fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut inside) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => inside = !inside,
            ',' if !inside => fields.push(String::new()),
            _ => fields.last_mut().unwrap().push(letter),
        }
    }
    assert!(!inside, "{line}");
    fields
}

/// What stands in a column of the line that begins so.
fn at(report: &Report, name: &str, begins: &str, column: &str) -> String {
    let mut lines = file(report, name).lines();
    let head = fields(lines.next().unwrap());
    let index = head.iter().position(|c| c == column).unwrap_or_else(|| panic!("no {column} in {head:?}"));
    fields(lines.find(|l| l.starts_with(begins)).unwrap_or_else(|| panic!("no {begins}")))[index].clone()
}

#[test]
fn figures_by_hand() {
    let report = report(&all_experiments());
    let number = |name, begins, column| at(&report, name, begins, column).parse::<f64>().unwrap();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    close(number("table1.csv", "12,clearway", "success [%]"), 200.0 / 3.0);
    close(number("table1.csv", "12,clearway", "removed sd"), 2f64.sqrt());
    close(number("table1.csv", "12,clearway", "time [ms] mean"), 20.0);
    close(number("table1.csv", "12,clearway", "p95 time [ms]"), 30.0);
    let line = "| 12 | clearway | 1 | 3 | 66.7 | 3.00 (1.41) | 20.0 (14.1) | 20.0 | 30.0 | 3.00 |";
    assert!(file(&report, "report.md").contains(line));
    assert!(file(&report, "report.md").contains("Scenes: 3. Runs: 4. Version: 1, of"));
    assert!(file(&report, "report.md").contains("refused: 1."));

    close(number("fig13.csv", "12,paper (1),1,", "roadmap nodes"), 15.0);
    close(number("fig13.csv", "12,paper (1),1,", "ratio"), 3.0);
    close(number("fig13.csv", "12,paper (1),2,", "retrieval graph nodes"), 6.0);
    close(number("fig13.csv", "12,paper (1),2,", "runs"), 1.0);
    close(number("fig14b.csv", "12,paper (1),2,", "samples mean"), 200.0);

    close(number("table4.csv", "12,streams", "fewest removals [%]"), 100.0 / 3.0);
    close(number("table4.csv", "12,streams", "median time [ms]"), 50.0);
    close(number("fig15_comparison.csv", "12,trav", "runs"), 2.0);
    close(number("fig15_comparison.csv", "12,trav", "ratio of mean times"), 0.5);
    close(number("fig15_comparison.csv", "12,trav", "difference of mean removals [%]"), -37.5);
    assert!(at(&report, "fig15_comparison.csv", "12,trav", "the paper's claim").starts_with("24.6 % less time, 16.1"));
    close(number("table5.csv", "100,clearway", "motion time [s] mean"), 0.625);
    assert_eq!(at(&report, "table5.csv", "100,clearway", "motion time [s] sd"), "");

    close(number("table6.csv", "2,", "exact time [ms] mean"), 500.0);
    close(number("table6.csv", "3,", "clearway removed mean"), 3.0);
    assert!(file(&report, "table6_runs.csv").contains("\n2,4,25,1,1,1,1,1\n3,1,100,0,0,0,0,0\n"));
    // Five runs of Clearway's with removals 2, 3, 5, 1, 3 and bound 2.
    assert!(file(&report, "lower_bounds.csv").contains("\noptimal,12,5,20,1,2,0,1,1,0,5,5\n"));
}

#[test]
fn any_rows_make_a_report() {
    assert!(file(&report(&[]), "report.md").contains("There are no rows."));
    let rows = all_experiments();
    let alone = rows.iter().map(|r| vec![r.clone()]);
    let unsolved = rows.iter().map(|r| Row { status: "impossible".to_owned(), ..r.clone() }).collect();
    let names = ["known", "graphs", "peers", "large", "optimal"];
    let experiments = names.map(|n| rows.iter().filter(|r| r.experiment == n).cloned().collect());
    for rows in alone.chain(experiments).chain([unsolved, vec![Row::default()]]) {
        let (files, again) = (report(&rows).files, report(&rows).files);
        assert_eq!(files, again);
        assert!(files.iter().all(|(_, text)| !text.contains("NaN") && !text.contains("inf")), "{rows:?}");
    }
}

#[test]
fn files_are_well_formed_and_named_in_the_document() {
    let report = report(&all_experiments());
    for (name, text) in &report.files[1..] {
        assert!(file(&report, "report.md").contains(&format!("]({name})")), "{name}");
        if name.ends_with(".csv") {
            let columns: BTreeSet<usize> = text.lines().map(|l| fields(l).len()).collect();
            assert!(columns.len() == 1 && text.lines().count() > 1, "{name}: {text}");
            continue;
        }
        let mut open = Vec::new();
        for tag in text.split('<').skip(1) {
            let (tag, text) = tag.split_once('>').unwrap();
            assert!(!text.contains('>') && tag.matches('"').count() % 2 == 0, "{name}: {tag}");
            match tag.strip_prefix('/') {
                Some(closed) => assert_eq!(open.pop(), Some(closed), "{name}"),
                None if tag.ends_with('/') => {}
                None => open.push(tag.split(' ').next().unwrap()),
            }
        }
        assert!(open.is_empty(), "{name}: {open:?}");
    }
    assert_eq!(report.files.iter().filter(|(name, _)| name.ends_with(".svg")).count(), 9);
}
