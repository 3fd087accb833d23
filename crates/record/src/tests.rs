//! Files in the styles of other programs, all of one swing.

mod instruments;

use crate::{
    Clock, ClockChoice, ClockKind, CsvColumns, Filter, Missing, ReadOptions, Record, Source, TimeUnit, Unit,
    look, read_text,
};

/// Returns the time in seconds and the angle in radians of a sample.
fn swing(index: usize) -> (f64, f64) {
    let time = index as f64 * 0.01;
    (time, 0.6 * (-0.2 * time).exp() * (9.0 * time).cos())
}

fn read_with(text: &str, columns: CsvColumns) -> (Record, Source) {
    let options = ReadOptions { columns, ..ReadOptions::default() };
    read_text("r.csv", text.as_bytes(), &options).unwrap_or_else(|error| panic!("{error}\n{text:.300}"))
}

fn read(text: &str) -> (Record, Source) {
    read_with(text, CsvColumns::default())
}

fn refusal(text: &str) -> String {
    read_text("r.csv", text.as_bytes(), &ReadOptions::default()).unwrap_err().to_string()
}

/// Returns a text of 200 samples below a header.
fn file(header: &str, row: impl Fn(usize, f64, f64) -> String) -> String {
    (0..200).fold(format!("{header}\n"), |text, index| {
        let (time, angle) = swing(index);
        text + &row(index, time, angle) + "\n"
    })
}

fn comma(number: f64, decimals: usize) -> String {
    format!("{number:.decimals$}").replace('.', ",")
}

/// Asserts that a record holds the swing, with stamps counted from the first.
fn holds_the_swing((record, source): &(Record, Source), tolerance: f64) {
    assert_eq!(record.len(), 200, "{}", source.reading.sentence);
    let first = record.stamps_s()[0];
    for (index, (stamp, value)) in record.stamps_s().iter().zip(record.values()).enumerate() {
        let (time, angle) = swing(index);
        assert!((stamp - first - time).abs() < 1e-6, "{index}: {stamp}; {}", source.reading.sentence);
        assert!((value - angle).abs() < tolerance, "{index}: {value} {angle}; {}", source.reading.sentence);
    }
}

#[test]
fn files_of_other_programs_are_read_without_options() {
    let deg = |angle: f64| angle.to_degrees();
    let epoch = |index: usize| 1_714_564_800_000_000_000_u64 + 10_000_000 * index as u64;
    let files = [
        file("Zeit [ms];Winkel [deg]", |_, t, a| format!("{};{}", comma(1e3 * t, 1), comma(deg(a), 5))),
        file("t|angle", |_, t, a| format!("{t:.2}|{a:.7}")),
        file("t\tangle", |_, t, a| format!("{t:.2}\t{a:.7}")),
        file("time   angle", |_, t, a| format!("  {t:.2}   {a:.7}")),
        file("# t angle", |_, t, a| format!("{t:.2} {a:.7}")),
        file("t,theta", |_, t, a| format!("\"{}\",\"{}\"", comma(t, 2), comma(a, 7))),
        file("%time,field.position0", |i, _, a| format!("{},{a:.7}", epoch(i))),
        file("header.stamp.secs,header.stamp.nsecs,position", |i, _, a| {
            format!("{},{},{a:.7}", epoch(i) / 1_000_000_000, epoch(i) % 1_000_000_000)
        }),
        file("stamp,angle (deg)", |i, _, a| {
            format!("2024-05-01T12:00:{:02}.{:03}Z,{:.6}", i / 100, i % 100 * 10, deg(a))
        }),
        file("time,position", |i, _, a| format!("16:04:{:02}.{:03},{a:.7}", 58 + i / 100, i % 100 * 10)),
        file("millis,angle_deg", |_, t, a| format!("{:.0},{:.6}", 1e3 * t, deg(a))),
        file("timestamp_us,theta_mrad", |_, t, a| format!("{:.0},{:.5}", 1e6 * t, 1e3 * a)),
        file("Elapsed;Angle\ns;deg", |_, t, a| format!("{t:.2};{:.6}", deg(a))),
        file("Pendulum log\nOperator: nobody\n\n// units are SI\ntime,q", |_, t, a| format!("{t:.2},{a:.7}")),
        file("\u{feff}Time [s],angle [°]\r", |_, t, a| format!("{t:.2},{:.6}\r", deg(a))),
        file("t,y", |_, t, a| format!("{t:.2},{a:.7}")),
        file("timestamp,observation.state,frame", |i, t, a| format!("{t:.2},{a:.7},{i}")),
        file("time_s,residual", |_, t, a| format!("{t:.2},{a:.7}")),
    ];
    for text in files {
        let text = text.replace("16:04:60", "16:05:00");
        holds_the_swing(&read(&text), 1e-6);
    }
}

#[test]
fn what_was_decided_is_said_in_one_line() {
    let text = file("Zeit [ms];Winkel [deg]", |i, t, a| {
        let angle = if i % 70 == 3 { String::new() } else { comma(a.to_degrees(), 5) };
        format!("{};{angle}", comma(1e3 * t, 1))
    });
    let (record, source) = read(&text);
    assert_eq!(record.len(), 197);
    assert_eq!(
        source.reading.sentence,
        "read as: semicolon-separated, decimal comma; time = \"Zeit [ms]\" in ms; value = \"Winkel [deg]\" in deg; no input; \
         3 missing cells left as gaps; rate 100.0 Hz"
    );
    let options: Vec<String> =
        source.reading.options().iter().map(|(key, value)| format!("{key}={value}")).collect();
    assert_eq!(
        options.join(" "),
        "format=csv time=Zeit [ms] time_unit=ms value=Winkel [deg] unit=deg missing=segment quantity=position"
    );
}

#[test]
fn a_missing_cell_is_a_gap_or_closed_up_or_refused() {
    for word in ["", "NaN", "nan", "NA", "null", "-", "inf", "-Inf"] {
        let text = file("angle_rad,note", |i, _, a| match i {
            50..60 => format!("{word},x"),
            _ => format!("{a:.7},x"),
        });
        let with = |missing| {
            let columns = CsvColumns { sample_rate_hz: Some(100.0), missing, ..CsvColumns::default() };
            let options = ReadOptions { columns, ..ReadOptions::default() };
            read_text("r.csv", text.as_bytes(), &options)
        };
        let (record, source) = with(Missing::Segment).unwrap();
        assert_eq!((record.len(), source.reading.missing_lines), (190, 10), "{word}");
        assert!((record.stamps_s()[50] - 0.6).abs() < 1e-9, "the gap stays");
        let (record, _) = with(Missing::Drop).unwrap();
        assert!((record.stamps_s()[50] - 0.5).abs() < 1e-9, "the lines close up");
        let refused = with(Missing::Refuse).unwrap_err().to_string();
        assert!(
            refused.starts_with("r.csv:52: 10 missing cells, the first in column `angle_rad`"),
            "{refused}"
        );
        assert!(refused.contains("data.missing"), "{refused}");
    }
}

/// Returns 10 s at 100 samples a second, with missing cells for a third of a second. `header` names the
/// columns and `line` writes a line.
fn with_a_hole(header: &str, line: impl Fn(usize, f64, &str) -> String) -> String {
    (0..1000).fold(format!("{header}\n"), |text, index| {
        let time = index as f64 / 100.0;
        let angle = 0.6 * (-0.1 * time).exp() * (8.0 * time).cos();
        let cell = if (300..333).contains(&index) { "NaN".to_owned() } else { format!("{angle:.7}") };
        text + &line(index, time, &cell) + "\n"
    })
}

fn clock_with(text: &str, missing: Missing, rate: Option<f64>, choice: ClockChoice) -> (Record, Clock) {
    let columns = CsvColumns { missing, sample_rate_hz: rate, ..CsvColumns::default() };
    let (record, _) = read_with(text, columns);
    let clock = Clock::new(&record, choice).unwrap();
    (record, clock)
}

/// Regression: a clock that is even in the index counted samples instead of rows, so all samples after a gap
/// came a third of a second early.
#[test]
fn a_uniform_index_counts_rows_without_a_value() {
    let stamped = with_a_hole("time_s,angle_rad", |_, time, cell| format!("{time:.2},{cell}"));
    let bare = with_a_hole("angle_rad", |_, _, cell| cell.to_owned());
    for (text, rate) in [(&stamped, None), (&bare, Some(100.0))] {
        for choice in [ClockChoice::UniformIndex, ClockChoice::Auto] {
            let (record, clock) = clock_with(text, Missing::Segment, rate, choice);
            assert_eq!((record.len(), record.empty_rows()), (967, 33));
            let off = record.stamps_s().iter().zip(&clock.times_s).map(|(stamp, time)| (stamp - time).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{choice:?} {}", clock.reason);
            assert!((clock.sample_rate_hz - 100.0).abs() < 1e-9, "{}", clock.sample_rate_hz);
            assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
            assert!(clock.reason.ends_with("; 33 rows without a value counted in"), "{}", clock.reason);
            assert_eq!((clock.statistics.gaps, clock.statistics.lost), (0, 0));
        }
    }
    let (record, clock) = clock_with(&stamped, Missing::Drop, None, ClockChoice::UniformIndex);
    let even = clock.times_s[300] - clock.times_s[299];
    assert!((even - (clock.times_s[1] - clock.times_s[0])).abs() < 1e-9, "dropped rows were never there");
    assert!((record.stamps_s()[300] - 3.33).abs() < 1e-9, "stamps stay as written");
}

/// Two sensors that take turns in one file: every other row is empty in the column that is read.
#[test]
fn rows_of_another_sensor_are_no_loss() {
    let text = (0..2000).fold("time_s,angle_rad,other\n".to_owned(), |text, index| {
        let time = index as f64 / 200.0;
        let angle = 0.6 * (-0.1 * time).exp() * (8.0 * time).cos();
        let cells = if index % 2 == 0 { format!("{angle:.7},") } else { ",1".to_owned() };
        text + &format!("{time:.3},{cells}\n")
    });
    let (record, clock) = clock_with(&text, Missing::Segment, None, ClockChoice::Auto);
    assert_eq!((record.len(), clock.statistics.gaps, clock.statistics.lost), (1000, 0, 0));
    assert!((clock.times_s[999] - clock.times_s[0] - 9.99).abs() < 1e-9, "{}", clock.reason);
}

/// Regression: duplicate lines of an export were taken for bursts, and the rate came out half as high again.
#[test]
fn a_line_that_stands_twice_is_read_once() {
    let text = file("time_s,angle_rad", |index, time, angle| {
        let line = format!("{time:.2},{angle:.7}");
        if index % 10 == 3 { format!("{line}\n{line}") } else { line }
    });
    let (record, source) = read(&text);
    holds_the_swing(&(record.clone(), source.clone()), 1e-6);
    assert!(source.findings[0].ends_with("lines repeat the one before, stamp and all, and were read once"));
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    assert_eq!((clock.statistics.repeated, clock.statistics.lost), (0, 0), "{}", clock.reason);
}

/// If only the sensor's cell is missing, the input is known; a line without an input contributes none.
#[test]
fn the_input_of_a_line_without_a_value_is_kept() {
    let stamped = with_a_hole("time_s,angle_rad,torque [mN m]", |index, time, cell| match index {
        310 => format!("{time:.2},{cell},"),
        _ => format!("{time:.2},{cell},{}", 1000 * index),
    });
    let bare = stamped.lines().map(|line| line.split_once(',').unwrap().1).collect::<Vec<_>>().join("\n");
    for (text, rate) in [(&stamped, None), (&bare, Some(100.0))] {
        for choice in [ClockChoice::UniformIndex, ClockChoice::Host] {
            let (record, clock) = clock_with(text, Missing::Segment, rate, choice);
            assert_eq!((record.len(), record.input().unwrap().len()), (967, 967));
            let rows: Vec<usize> = record.input_rows().iter().map(|own| own.row).collect();
            assert_eq!(rows, (300..333).filter(|row| *row != 310).collect::<Vec<_>>());
            for (own, (time, _)) in record.input_rows().iter().zip(clock.inputs_between(&record)) {
                assert!((own.input - own.row as f64).abs() < 1e-9, "in N m: {own:?}");
                assert!((time - own.row as f64 / 100.0).abs() < 1e-9, "{choice:?}: {own:?} at {time}");
            }
            let doubled = record.mapped(|value| value, |input| 2.0 * input).unwrap();
            assert_eq!(doubled.input_rows()[0].input, 2.0 * record.input_rows()[0].input);
            assert_eq!(doubled.rows(), record.rows());
        }
    }
    let (record, _) = clock_with(&stamped, Missing::Drop, None, ClockChoice::Host);
    assert!(record.input_rows().is_empty(), "a dropped line was never there");
}

/// Stamps of bursts with a hole: groups are numbered by rows, and no other samples count as lost.
#[test]
fn bursts_with_missing_cells_have_lost_nothing() {
    let text =
        with_a_hole("time_s,angle_rad", |index, _, cell| format!("{:.3},{cell}", (index / 8) as f64 * 0.08));
    let (_, clock) = clock_with(&text, Missing::Segment, None, ClockChoice::Auto);
    assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
    assert_eq!((clock.statistics.lost, clock.statistics.largest_group), (0, 8));
    let step = clock.times_s[300] - clock.times_s[299];
    assert!((step - 0.34).abs() < 1e-3, "{step}");
}

#[test]
fn one_series_of_several_is_chosen() {
    let text = (0..200).fold("time_s,joint,angle_rad\n".to_owned(), |text, index| {
        let (time, angle) = swing(index);
        text + &format!("{time:.2},Rotation,{angle:.7}\n{time:.2},Pitch,{:.7}\n", 2.0 * angle)
    });
    let message = refusal(&text);
    assert!(message.contains("column `joint` distinguishes 2 series: Rotation, Pitch"), "{message}");
    assert!(message.ends_with("set `data.where` to joint=Rotation"), "{message}");
    let chosen = |value: &str| CsvColumns {
        filter: Some(Filter { column: "joint".to_owned(), value: value.to_owned() }),
        ..CsvColumns::default()
    };
    holds_the_swing(&read_with(&text, chosen("Rotation")), 1e-6);
    let options = ReadOptions { columns: chosen("Elbow"), ..ReadOptions::default() };
    let message = read_text("r.csv", text.as_bytes(), &options).unwrap_err().to_string();
    assert!(
        message.contains("no line has `Elbow` in column `joint`, which holds Rotation, Pitch"),
        "{message}"
    );
    let after = text.replace("joint", "run");
    assert!(
        read_text("r.csv", after.as_bytes(), &ReadOptions::default()).is_ok(),
        "equal stamps are no series"
    );
}

#[test]
fn columns_that_tie_are_listed() {
    let message = refusal(&file("time_s,q1,q2,tau1", |_, t, a| format!("{t},{a},{a},0")));
    assert!(
        message
            .ends_with("`q1`, `q2` could each be the observed column; set `data.value` to the name of one")
    );
    let (_, source) = read_with(
        &file("time_s,q1,tau1,tau2", |_, t, a| format!("{t},{a},1,2")),
        CsvColumns { value: Some("q1".to_owned()), ..CsvColumns::default() },
    );
    assert_eq!(source.reading.input, None);
    assert!(source.findings[0].contains("`tau1`, `tau2` could each be the input"), "{:?}", source.findings);
}

#[test]
fn another_column_that_could_be_observed_is_told() {
    let findings = |header| read(&file(header, |_, t, a| format!("{t},{a},{a}"))).1.findings;
    assert_eq!(
        findings("time_s,roll_rad,pitch_rad"),
        ["`roll_rad` was taken and not `pitch_rad`; name another with `data.value`"]
    );
    // A derivative of the same motion, or the same angle in another unit, is not another motion.
    assert!(findings("time_s,angle_rad,velocity").is_empty());
    assert!(findings("time_s,angle_rad,angle_deg").is_empty());
}

#[test]
fn the_nominal_coordinate_chooses_among_columns() {
    let text = file("time_s,angle_rad,displacement_mm,command", |_, t, a| {
        format!("{t},{a},{},{}", 2e3 * a, 0.6 * (5.0 * t).cos())
    });
    let options =
        |coordinate| ReadOptions { coordinate: Some(coordinate), driven: true, ..ReadOptions::default() };
    let (record, source) =
        read_text("r", text.as_bytes(), &options(crate::Coordinate::Displacement)).unwrap();
    assert_eq!((record.unit(), record.values()[0]), ("m", 1.2));
    // A command without a unit has the unit of the position in the same file.
    assert!((record.input().unwrap()[0] - 0.6e-3).abs() < 1e-12);
    assert!(source.findings[0].contains("taken to be in mm"), "{:?}", source.findings);
    let (record, _) = read_text("r", text.as_bytes(), &options(crate::Coordinate::Angle)).unwrap();
    assert_eq!((record.unit(), record.values()[0]), ("rad", 0.6));
}

#[test]
fn inputs_are_converted_by_their_header_or_the_option() {
    let text = file("t,angle_deg,torque [mN m]", |_, t, a| format!("{t},{},250", a.to_degrees()));
    assert!((read(&text).0.input().unwrap()[0] - 0.25).abs() < 1e-12);
    let text = file("t,angle_deg,u", |_, t, a| format!("{t},{},90", a.to_degrees()));
    let columns =
        CsvColumns { input: Some("u".to_owned()), input_unit: Some(Unit::Degree), ..CsvColumns::default() };
    let (record, source) = read_with(&text, columns);
    assert!((record.input().unwrap()[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert!(source.findings.is_empty(), "{:?}", source.findings);
}

#[test]
fn the_observed_column_is_no_input() {
    let text = file("t,angle_deg,u", |_, t, a| format!("{t},{},90", a.to_degrees()));
    for input in ["angle_deg", "t"] {
        let columns = CsvColumns { input: Some(input.to_owned()), ..CsvColumns::default() };
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let said = read_text("r.csv", text.as_bytes(), &options).unwrap_err().to_string();
        assert!(said.contains(&format!("column `{input}`")) && said.contains("`data.input`"), "{said}");
    }
}

#[test]
fn odd_rates_and_angles_are_remarked() {
    let text = file("time,angle", |_, t, a| format!("{:.0},{}", 1e3 * t, a.to_degrees()));
    let (record, source) = read(&text);
    assert!(source.findings[0].contains("were taken to be in ms"), "{:?}", source.findings);
    assert!(source.findings[1].contains("taken to be in deg, since they go out to"), "{:?}", source.findings);
    holds_the_swing(&(record, source), 1e-6);
    let finer = file("time,angle", |_, t, a| format!("{:.1},{}", 1e3 * t + 0.5, 0.1 * a.to_degrees()));
    let (_, source) = read(&finer);
    assert!(source.findings[0].contains("if it is in ms, set `data.time_unit`"), "{:?}", source.findings);
    assert!(source.findings[1].contains("a factor of 57.3"), "{:?}", source.findings);
    let (_, source) = read_with(
        &text,
        CsvColumns {
            time_unit: Some(TimeUnit::Millisecond),
            unit: Some(Unit::Degree),
            ..CsvColumns::default()
        },
    );
    assert!(source.findings.is_empty(), "{:?}", source.findings);
}

/// A column without a unit is taken to be in SI units; a finding reports values that suggest another unit.
#[test]
fn numbers_that_are_rather_in_another_unit_are_told() {
    let told = |header: &str, value: &dyn Fn(f64) -> f64| {
        let (_, source) = read(&file(header, |_, t, a| format!("{t:.2},{:.6}", value(a))));
        assert!(source.reading.sentence.contains("(assumed)"), "{}", source.reading.sentence);
        source.findings.join(" ")
    };
    let said = told("time_s,angle", &|a| 5.0 * a);
    assert!(
        said.contains("if they are degrees (a factor of 57.3), 2.9 of them, set `data.unit` to deg"),
        "{said}"
    );
    assert_eq!(told("time_s,angle", &|a| a), "");
    let said = told("time_s,gyro_z", &|a| 400.0 * a);
    assert!(said.contains("degrees a second (a factor of 57.3), set `data.unit` to deg/s"), "{said}");
    assert_eq!(told("time_s,gyro_z", &|a| 10.0 * a), "");
    let said = told("time_s,acc_x", &|a| 1.0 + 0.2 * a);
    assert!(said.contains("in g (a factor of 9.81), set `data.unit` to g"), "{said}");
    assert_eq!(told("time_s,acc_x", &|a| 2.0 * a), "");
    // A header that states rad above degrees, and one above a real swing.
    let text = file("time,angle_rad", |_, t, a| format!("{t},{}", 100.0 * a));
    assert!(read(&text).1.findings[0].contains("the header says rad"), "{:?}", read(&text).1.findings);
    let text = file("time,angle_rad", |_, t, a| format!("{t},{}", 3.0 * a));
    assert!(read(&text).1.findings.is_empty(), "{:?}", read(&text).1.findings);
}

#[test]
fn a_unit_that_is_not_known_is_told() {
    let (_, source) =
        read(&file("time_s,angle [grd],torque [lbf ft]", |_, t, a| format!("{t:.2},{a:.6},0.1")));
    let said = source.findings.join(" ");
    assert!(said.contains("the header `angle [grd]` states `grd`, which is no known unit"), "{said}");
    assert!(said.contains("`lbf ft`") && said.contains("set `data.input_unit`"), "{said}");
    let (_, source) = read(&file("time_s,angle (deg)", |_, t, a| format!("{t:.2},{a:.6}")));
    assert!(source.findings.is_empty(), "{:?}", source.findings);
}

#[test]
fn torques_in_kilogram_force_are_converted() {
    for (header, factor) in [
        ("t,angle_rad,torque [kgf m]", 9.806_65),
        ("t,angle_rad,torque (kg cm)", 0.098_066_5),
        ("t,angle_rad,torque_kgf_cm", 0.098_066_5),
        ("t,angle_rad,force [kgf]", 9.806_65),
    ] {
        let (record, source) = read(&file(header, |_, t, a| format!("{t},{a},2")));
        assert!((record.input().unwrap()[0] - 2.0 * factor).abs() < 1e-12, "{header}");
        assert!(source.findings.is_empty(), "{header}: {:?}", source.findings);
    }
}

#[test]
fn files_that_do_not_say_enough_get_the_key_to_set() {
    for text in ["0.0,0.5\n0.1,0.4\n", "0.0;0.5\n", "0,0;0,5\n", "0.0 0.5\n", "-1e-3\t2\n"] {
        let message = refusal(text);
        assert!(message.contains("no column is a time") || message.contains("at least 8"), "{message}");
    }
    for (text, expected) in [
        (
            "my angle\n0.5\n",
            "the columns are `my angle`. Set `data.time` to the column's name, or `data.sample_rate_hz`",
        ),
        ("t,foo,bar\n0,1,2\n1,2,3\n", "`foo`, `bar` could each be the observed column; set `data.value`"),
        ("time_s,angle_deg\n0,01,29,20\n", "r.csv:2: 4 fields under a header of 2; "),
        ("time_s,angle_deg\n0,1\n1,x\n2,2\n", "r.csv:3: `x` in column `angle_deg` is not a number"),
    ] {
        let message = refusal(text);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_separator_at_the_end_of_each_line_is_no_field() {
    holds_the_swing(&read(&file("time_s,angle_rad", |_, t, a| format!("{t:.2},{a:.7},"))), 1e-6);
}

#[test]
fn a_look_tells_columns_and_rate() {
    let text = file("t_ms;joint;angle [deg]", |_, t, a| format!("{};a;{}", 1e3 * t, a.to_degrees()));
    let found = look("log.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    let columns: Vec<_> =
        found.columns.iter().map(|column| (column.role, column.unit.as_deref(), column.holds)).collect();
    assert_eq!(
        columns,
        [
            (Some("time"), Some("ms"), "numbers"),
            (None, None, "text"),
            (Some("value"), Some("deg"), "numbers")
        ]
    );
    assert!((found.clock.sample_rate_hz - 100.0).abs() < 1e-6);
}

/// Options take precedence; a finding reports a header that states another unit.
#[test]
fn a_unit_that_contradicts_the_header_is_told() {
    let text = file("timestamp_ms,displacement_m", |index, _, angle| format!("{},{angle:.6}", 10 * index));
    let told = |columns: CsvColumns| read_with(&text, columns).1.findings.join(" ");
    let unit = told(CsvColumns { unit: Some(Unit::Millimeter), ..CsvColumns::default() });
    assert!(
        unit.contains("the header `displacement_m` states m, the options say mm and are followed"),
        "{unit}"
    );
    let time = told(CsvColumns { time_unit: Some(TimeUnit::Second), ..CsvColumns::default() });
    assert!(time.contains("the header `timestamp_ms` states ms, the options say s"), "{time}");
    let same = CsvColumns {
        unit: Some(Unit::Meter),
        time_unit: Some(TimeUnit::Millisecond),
        ..CsvColumns::default()
    };
    assert_eq!(told(same), "");
}

/// Spreadsheets and older loggers write the degree sign in one byte, or every character in two.
#[test]
fn latin_and_utf_16_are_read() {
    let text = file("time_s;angle [°]", |_, time, angle| format!("{time:.2};{:.6}", angle.to_degrees()));
    let latin: Vec<u8> = text.chars().map(|sign| u8::try_from(u32::from(sign)).unwrap()).collect();
    let wide: Vec<u8> =
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    for bytes in [latin, wide] {
        let read = read_text("r.csv", &bytes, &ReadOptions::default()).unwrap();
        holds_the_swing(&read, 1e-7);
    }
}

#[test]
fn files_that_are_no_text_are_told_by_their_beginning() {
    let refused = |bytes: &[u8]| read_text("log", bytes, &ReadOptions::default()).unwrap_err().to_string();
    for (bytes, words) in [
        (&b"PK\x03\x04\x14\x00"[..], "is a ZIP archive, as Excel's workbooks (.xlsx) are, not a text file"),
        (b"PAR1\x15\x04", "pandas.read_parquet("),
        (b"MATLAB 5.0 MAT-file", "its header is incomplete or damaged; write its columns as text"),
        (b"MATLAB 7.3 MAT-file", "h5py.File("),
        (b"\x89HDF\r\n", "h5py.File("),
        (b"\x89MCAP0\r\n", "make_reader("),
        (b"#ROSBAG V2.0\n", "logs.read_rosbag"),
        (b"\x7fELF\x02\x01\x01\0\0", "is no text (byte 7)"),
    ] {
        assert!(refused(bytes).contains(words), "{}", refused(bytes));
    }
}
