use super::*;

#[test]
fn intervals_cover_the_truth_about_as_often_as_their_level() {
    let cells = simulate_all(25, 1);
    assert_eq!(cells.len(), SimulatedFigure::ALL.len() * SIMULATED_DESIGNS.len() * EffectSize::ALL.len());
    for figure in SimulatedFigure::ALL {
        let of: Vec<&CoverageCell> = cells.iter().filter(|cell| cell.figure == figure).collect();
        let [given, covered] =
            [of.iter().map(|cell| cell.given).sum::<u64>(), of.iter().map(|cell| cell.covered).sum()];
        assert!(given > 100 && covered * 100 > given * 90, "{figure}: {covered} of {given}");
    }
}

#[test]
fn a_study_without_two_answers_to_an_item_has_no_alpha() {
    let cell = simulate_cell(SimulatedFigure::Alpha, SIMULATED_DESIGNS[0], EffectSize::Middle, &[0.0], 3, 0);
    assert_eq!((cell.given, cell_text(&cell)), (0, "-".to_owned()));
}

#[test]
fn a_table_has_a_row_for_each_figure_and_a_column_for_each_kind_of_study() {
    let cell = |figure, covered| CoverageCell {
        figure,
        design: SIMULATED_DESIGNS[0],
        effects: EffectSize::None,
        studies: 10,
        wanted: 10,
        given: 8,
        covered,
        mean_width: 0.1,
    };
    let rows = coverage_rows(&[
        cell(SimulatedFigure::Share(0.5), 8),
        cell(SimulatedFigure::Share(0.5), 6),
        cell(SimulatedFigure::Alpha, 4),
    ]);
    assert_eq!((rows.len(), rows[0].len(), rows[0][1].as_str()), (3, 10, "30 x 1 none"));
    assert_eq!(rows[1], ["share, 0.5", "100.0 (80.0)", "75.0 (80.0)"]);
    assert_eq!(rows[2], ["Krippendorff's alpha", "50.0 (80.0)"]);
}

#[test]
fn a_seed_gives_one_result() {
    let with =
        |seed| simulate_cell(SimulatedFigure::Mean(0.5), SIMULATED_DESIGNS[2], EffectSize::Large, &[0.4], 5, seed);
    assert_eq!(with(1), with(1));
    assert_ne!(with(1), with(2));
}
