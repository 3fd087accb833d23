//! Files of every kind, built byte by byte.

use super::Unread;
use crate::{ReadOptions, Record, read_text};
use flate2::Compression;
use flate2::write::{DeflateEncoder, ZlibEncoder};
use std::io::Write;

/// Number of samples of the swing.
const SAMPLES: usize = 40;

/// Returns the time in seconds and the angle of a sample.
fn swing(index: usize) -> (f64, f64) {
    let time = index as f64 / 64.0;
    (time, 0.5 * (-0.2 * time).exp() * (9.0 * time).cos())
}

fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    super::table(bytes).map(|read| read.map(|contained| contained.text))
}

fn table(bytes: &[u8]) -> String {
    text(bytes).expect("a known kind").unwrap_or_else(|unread| panic!("{unread}"))
}

fn problem(bytes: &[u8]) -> String {
    text(bytes).expect("a known kind").unwrap_err().to_string()
}

fn record(bytes: &[u8], options: &ReadOptions) -> Record {
    read_text("record", bytes, options).unwrap_or_else(|error| panic!("{error}")).0
}

/// Asserts that a file is read as the swing, exactly.
fn holds_the_swing(bytes: &[u8]) {
    let record = record(bytes, &ReadOptions::default());
    let (stamps, values): (Vec<f64>, Vec<f64>) = (0..SAMPLES).map(swing).unzip();
    assert_eq!((record.stamps_s(), record.values()), (stamps.as_slice(), values.as_slice()));
}

/// Returns the swing's times and angles as bytes, made by `bytes` and chained sample by sample.
fn interleaved(bytes: impl Fn(f64) -> [u8; 8]) -> Vec<u8> {
    (0..SAMPLES).map(swing).flat_map(|(time, angle)| [time, angle]).flat_map(bytes).collect()
}

/// Returns all times, then all angles.
fn one_after_another() -> Vec<u8> {
    let (times, angles): (Vec<f64>, Vec<f64>) = (0..SAMPLES).map(swing).unzip();
    times.into_iter().chain(angles).flat_map(f64::to_le_bytes).collect()
}

/// Returns an array file.
fn npy(version: u8, descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// Returns an archive of files, deflated or stored.
fn zip(files: &[(&str, Vec<u8>)], deflated: bool) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let packed = if deflated {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(content).unwrap();
            encoder.finish().unwrap()
        } else {
            content.clone()
        };
        let mut crc = flate2::Crc::new();
        crc.update(content);
        let mut shared = vec![20, 0, 0, 0, if deflated { 8 } else { 0 }, 0, 0, 0, 0, 0];
        for number in [crc.sum(), packed.len() as u32, content.len() as u32, name.len() as u32] {
            shared.extend(number.to_le_bytes());
        }
        directory.extend([b"PK\x01\x02\x14\0", shared.as_slice(), &[0; 10]].concat());
        directory.extend((bytes.len() as u32).to_le_bytes());
        directory.extend(name.as_bytes());
        bytes.extend([b"PK\x03\x04", shared.as_slice(), name.as_bytes(), &packed].concat());
    }
    let (count, start) = (files.len() as u16, bytes.len() as u32);
    bytes.extend(&directory);
    bytes.extend([b"PK\x05\x06\0\0\0\0".as_slice(), &count.to_le_bytes(), &count.to_le_bytes()].concat());
    bytes.extend([(directory.len() as u32).to_le_bytes(), start.to_le_bytes()].concat());
    bytes.extend([0, 0]);
    bytes
}

/// Returns an archive with the swing in two arrays, and its sampling rate.
fn npz(deflated: bool) -> Vec<u8> {
    let data = one_after_another();
    let array = |data: &[u8]| npy(1, "'<f8'", "False", "(40,)", data);
    let files = [
        ("time.npy", array(&data[..8 * SAMPLES])),
        ("angle.npy", array(&data[8 * SAMPLES..])),
        ("sample_rate_hz.npy", npy(1, "'<f8'", "False", "()", &64_f64.to_le_bytes())),
        ("note.npy", npy(1, "'|O'", "False", "()", b"pickle")),
    ];
    zip(&files, deflated)
}

/// Returns a WAVE file of two channels at 8 Hz, with an unknown chunk before the samples.
fn wav(tag: u16, size: u16, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"RIFF\0\0\0\0WAVELIST\x03\0\0\0abc\0fmt \x10\0\0\0".to_vec();
    bytes.extend(tag.to_le_bytes());
    bytes.extend(2_u16.to_le_bytes());
    bytes.extend(8_u32.to_le_bytes());
    bytes.extend((8 * 2 * u32::from(size)).to_le_bytes());
    bytes.extend((2 * size).to_le_bytes());
    bytes.extend((8 * size).to_le_bytes());
    bytes.extend([b"data", (data.len() as u32).to_le_bytes().as_slice(), data].concat());
    bytes
}

/// Returns a LabVIEW file; `columns` is its kind of time columns, `body` all from the first segment on.
fn lvm(columns: &str, body: &str) -> Vec<u8> {
    let head = "LabVIEW Measurement\t\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\nX_Columns\t";
    format!("{head}{columns}\r\nTime\t09:51:39,19\r\n***End_of_Header***\t\r\n\t\r\n{body}").into_bytes()
}

/// Returns a segment with even times: two rows, beginning at a time of the day.
fn segment(time: &str, value: &str) -> String {
    format!(
        "Channels\t1\t\nDate\t2024/05/01\t\nTime\t{time}\t\nX_Dimension\tTime\t\nX0\t0,0\t\nDelta_X\t2,5E-1\t\n\
         ***End_of_Header***\t\t\nX_Value\tUntitled\tComment\n\t{value}\n\t-1,25\tstarted\n"
    )
}

/// Returns an element of a MATLAB file: its type and its bytes, padded.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// Returns a variable of a MATLAB file: a class, a name of at most four letters, lengths of sides, its content.
fn matrix(class: u32, name: &str, sides: [u32; 2], content: &[u8]) -> Vec<u8> {
    let small = [&(1 | (name.len() as u32) << 16).to_le_bytes()[..], name.as_bytes(), &[0; 4][name.len()..]];
    let sides = sides.map(u32::to_le_bytes).concat();
    let flags = element(6, &[class.to_le_bytes(), [0; 4]].concat());
    element(14, &[flags, element(5, &sides), small.concat(), content.to_vec()].concat())
}

/// Returns a MATLAB file.
fn mat(variables: &[Vec<u8>]) -> Vec<u8> {
    let header = format!("{:116}", "MATLAB 5.0 MAT-file, Platform: GLNXA64").into_bytes();
    [header, vec![0; 8], vec![0, 1, b'I', b'M'], variables.concat()].concat()
}

/// Returns the swing's times and angles as two vectors of a MATLAB file, a lying and a standing one.
fn vectors() -> [Vec<u8>; 2] {
    let all = one_after_another();
    let (times, angles) = all.split_at(8 * SAMPLES);
    let samples = SAMPLES as u32;
    [matrix(6, "t", [1, samples], &element(9, times)), matrix(6, "phi", [samples, 1], &element(9, angles))]
}

fn deflated(variable: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(variable).unwrap();
    let packed = encoder.finish().unwrap();
    [&15_u32.to_le_bytes()[..], &(packed.len() as u32).to_le_bytes(), &packed].concat()
}

#[test]
fn matlab_variables_are_columns_packed_or_not() {
    let text = matrix(4, "unit", [1, 3], &element(4, b"r\0a\0d\0"));
    let gain = matrix(6, "gain", [1, 1], &element(2, &[7]));
    let variables = [&[text, gain][..], &vectors()].concat();
    holds_the_swing(&mat(&variables));
    holds_the_swing(&mat(&variables.iter().map(|variable| deflated(variable)).collect::<Vec<_>>()));
    let table_alone = matrix(6, "log", [SAMPLES as u32, 2], &element(9, &one_after_another()));
    holds_the_swing(&mat(&[table_alone]));
    let small = matrix(8, "a", [1, 4], &[1_u32 | 4 << 16, 0x04ff_0201].map(u32::to_le_bytes).concat());
    assert_eq!(table(&mat(&[small])), "a\n1\n2\n-1\n4\n");
}

#[test]
fn fields_of_a_matlab_structure_are_columns() {
    let names = element(1, b"time\0phi\0\0");
    let width = [5_u32 | 4 << 16, 5].map(u32::to_le_bytes).concat();
    let log = matrix(2, "log", [1, 1], &[width, names, vectors().concat()].concat());
    assert!(table(&mat(std::slice::from_ref(&log))).starts_with("log.time,log.phi\n0,0.5\n"));
    holds_the_swing(&mat(&[log]));
}

#[test]
fn matlab_variables_that_are_no_columns_are_named_with_what_converts_them() {
    let cell = problem(&mat(&[matrix(1, "c", [1, 1], &[])]));
    assert!(cell.contains("its variable `c` is a cell array; write its columns as text"), "{cell}");
    assert!(cell.contains("scipy.io.loadmat('in.mat')"), "{cell}");
    let short = problem(&mat(&[matrix(6, "x", [1, 9], &element(9, &[0; 8]))]));
    assert!(short.contains("of its variable `x`, it is cut off"), "{short}");
    let newer = problem(b"MATLAB 7.3 MAT-file, Platform: GLNXA64");
    assert!(newer.contains("version 7.3") && newer.contains("h5py.File('in.mat')"), "{newer}");
}

#[test]
fn labview_files_are_read_with_every_kind_of_time_columns() {
    let header = "Channels\t2\t\t\nY_Unit_Label\tNewtons\tdeg\t\nDelta_X\t0,1\t0,1\t\n***End_of_Header***\n";
    let one =
        lvm("One", &format!("{header}X_Value\tload\tAngle\tComment\n0,5\t1\t-2,5E-1\n0,6\t\t3\tlost\n"));
    assert_eq!(table(&one), "time_s,\"load [Newtons]\",\"Angle [deg]\"\n0.5,1,-0.25\n0.6,,3\n");
    let none = lvm("No", &format!("{header}X_Value\tload\tAngle\tComment\n\t1\t2\n\t3\t4\n"));
    assert_eq!(table(&none), "time_s,\"load [Newtons]\",\"Angle [deg]\"\n0,1,2\n0.1,3,4\n");
    let header =
        "Channels\t2\t\t\t\nY_Unit_Label\tV\t\tg\t\nX_Dimension\tTime\t\tTime\t\n***End_of_Header***\n";
    let multi =
        lvm("Multi", &format!("{header}X_Value\tU\tX_Value\tA\tComment\n0\t1\t0,5\t2\n0,1\t3\t0,6\t4\n"));
    assert_eq!(table(&multi), "time_s,\"U [V]\",time_s,\"A [g]\"\n0,1,0.5,2\n0.1,3,0.6,4\n");
    let commas = "LabVIEW Measurement,\nSeparator,Comma\nX_Columns,One\n***End_of_Header***,\n,\nChannels,1,\n\
                  ***End_of_Header***,,\nX_Value,Angle,Comment\n0.5,1.5,\n";
    assert_eq!(table(commas.as_bytes()), "time_s,Angle\n0.5,1.5\n");
    let frequency = lvm("One", "Channels\t1\nX_Dimension\tFrequency\nX_Value\tA\n0\t1\n");
    assert!(problem(&frequency).contains("over `Frequency` and not over time"));
}

#[test]
fn labview_segments_are_joined_while_time_goes_on() {
    let first = segment("12:00:00,75", "1");
    let joined = lvm("No", &format!("{first}\n{}", segment("12:00:01,25", "2")));
    assert_eq!(table(&joined), "time_s,Untitled\n0,1\n0.25,-1.25\n0.5,2\n0.75,-1.25\n");
    let other = lvm("No", &format!("{first}\n{}", segment("11:00:00", "2")));
    assert_eq!(table(&other), "time_s,Untitled\n0,1\n0.25,-1.25\n");
}

#[test]
fn arrays_are_read_in_every_version_order_and_type() {
    let rows = interleaved(f64::to_le_bytes);
    holds_the_swing(&npy(1, "'<f8'", "False", "(40, 2)", &rows));
    holds_the_swing(&npy(2, "'<f8'", "False", "(40, 2)", &rows));
    holds_the_swing(&npy(3, "'>f8'", "False", "(40, 2)", &interleaved(f64::to_be_bytes)));
    holds_the_swing(&npy(1, "'<f8'", "True", "(40, 2)", &one_after_another()));
    holds_the_swing(&npy(1, "'<f8'", "False", "(2, 40)", &one_after_another()));
    holds_the_swing(&npy(1, "[('t', '<f8'), ('theta', '<f8')]", "False", "(40,)", &rows));
    for (descr, data, expected) in [
        ("'|i1'", vec![255, 7], "-1,7"),
        ("'|u1'", vec![255, 7], "255,7"),
        ("'>i2'", vec![255, 254, 0, 7], "-2,7"),
        ("'<i8'", [(-3_i64).to_le_bytes(), 7_i64.to_le_bytes()].concat(), "-3,7"),
        ("'<u8'", [u64::MAX.to_le_bytes(), 7_u64.to_le_bytes()].concat(), "18446744073709551615,7"),
        ("'<f4'", [0.1_f32.to_le_bytes(), f32::NAN.to_le_bytes()].concat(), "0.1,-"),
        ("'<f2'", vec![0x00, 0xb8, 0x01, 0x00], "-0.5,0.000000059604645"),
        ("'|b1'", vec![1, 0], "1,0"),
        ("'<U1'", vec![b'a', 0, 0, 0, 0xb1, 3, 0, 0], "a,α"),
    ] {
        let lines = format!("value\n{}\n", expected.replace(',', "\n"));
        assert_eq!(table(&npy(1, descr, "False", "(2,)", &data)), lines, "{descr}");
    }
    let fields = "[('t', '<M8[ms]'), ('', '|V1'), ('w', '|i1', (2,))]";
    let data = [&5_i64.to_le_bytes()[..], &[9, 1, 2], &i64::MIN.to_le_bytes()[..], &[9, 3, 4]].concat();
    assert_eq!(table(&npy(1, fields, "False", "(2,)", &data)), "\"t [ms]\",w_1,w_2\n5,1,2\n,3,4\n");
}

#[test]
fn an_array_without_times_needs_a_sampling_rate() {
    let angles = one_after_another()[8 * SAMPLES..].to_vec();
    let file = npy(1, "'<f8'", "False", "(40,)", &angles);
    let refusal = read_text("a", &file, &ReadOptions::default()).unwrap_err().to_string();
    assert!(refusal.contains("data.sample_rate_hz"), "{refusal}");
    let mut options = ReadOptions::default();
    options.columns.sample_rate_hz = Some(64.0);
    let record = record(&file, &options);
    assert_eq!((record.len(), record.stamps_s()[1]), (SAMPLES, 1.0 / 64.0));
    let falling: Vec<u8> = (0..16_u8).rev().collect();
    assert!(table(&npy(1, "'|u1'", "False", "(8, 2)", &falling)).starts_with("column_1,column_2\n15,14\n"));
}

#[test]
fn arrays_that_are_no_table_are_refused_with_a_remedy() {
    for (descr, shape, expected) in [
        ("'<f8'", "(41, 2)", "cut off"),
        ("'<f8'", "(4611686018427387904, 4)", "cut off"),
        ("'<f8'", "(99999999999999, 0)", "empty"),
        ("'<f8'", "(2, 4, 5)", "3 dimensions"),
        ("'<c16'", "(4,)", "complex"),
        ("'|O'", "(4,)", "Python objects"),
        ("'|S0'", "(99999999999999,)", "type `|S0`"),
        ("[('a', '|i1', (99999999999,))]", "(99,)", "cut off"),
        ("[('a', [('b', '<f8')])]", "(4,)", "fields of their own"),
    ] {
        let found = problem(&npy(1, descr, "False", shape, &[0; 640]));
        assert!(found.contains(expected) && found.contains("\n    numpy.savetxt("), "{descr}: {found}");
    }
}

#[test]
fn archives_of_arrays_are_read_stored_and_deflated() {
    for deflated in [false, true] {
        let archive = npz(deflated);
        holds_the_swing(&archive);
        assert!(table(&archive).starts_with("# sample_rate_hz: 64\ntime,angle\n0,0.5\n"));
    }
    let rows = npy(1, "'<f8'", "False", "(40, 2)", &interleaved(f64::to_le_bytes));
    holds_the_swing(&zip(&[("arr_0.npy", rows.clone())], true));
    let short = npy(1, "'|u1'", "False", "(9,)", &[0; 9]);
    let unequal = problem(&zip(&[("a.npy", rows), ("b.npy", short)], true));
    assert!(unequal.contains("`a_1` has 40 entries and `b` has 9"), "{unequal}");
    assert_eq!(text(&zip(&[("xl/workbook.xml", vec![1])], true)), None);
    let mut damaged = npz(false);
    damaged[200] ^= 1;
    assert!(problem(&damaged).contains("`time.npy` is damaged"));
    assert!(problem(&npz(true)[..300]).contains("its directory is missing"));
}

#[test]
fn a_small_archive_that_unpacks_to_very_much_is_refused() {
    let mut bomb = zip(&[("a.npy", vec![0; 2_000_000])], true);
    let size = bomb.windows(4).rposition(|window| window == 2_000_000_u32.to_le_bytes()).unwrap();
    bomb[size..size + 4].copy_from_slice(&0xfff0_0000_u32.to_le_bytes());
    assert!(problem(&bomb).contains("4095 MB"));
}

#[test]
fn wave_files_are_read_as_fractions_of_full_scale() {
    let two =
        |tag, size, data: &[u8]| table(&wav(tag, size, data)).lines().skip(1).collect::<Vec<_>>().join(";");
    assert_eq!(two(1, 1, &[0, 192, 128, 64]), "0,-1,0.5;0.125,0,-0.5");
    assert_eq!(two(1, 2, &[0, 128, 0, 64, 1, 0, 0, 0]), "0,-1,0.5;0.125,0.000030517578125,0");
    assert_eq!(two(1, 3, &[0, 0, 0x80, 0, 0, 0x40]), "0,-1,0.5");
    assert_eq!(two(1, 4, &[0, 0, 0, 0x80, 0, 0, 0, 0x40]), "0,-1,0.5");
    assert_eq!(two(3, 4, &[0.1_f32, -0.3].map(f32::to_le_bytes).concat()), "0,0.1,-0.3");
    assert_eq!(two(3, 8, &[0.1_f64, -0.3].map(f64::to_le_bytes).concat()), "0,0.1,-0.3");
    // The last frame is incomplete.
    assert_eq!(two(1, 2, &[0, 64, 0, 64, 1]), "0,0.5,0.5");
    let mut streamed = wav(1, 1, &[0, 192]);
    let size = streamed.len() - 6;
    streamed[size..size + 4].copy_from_slice(&[255; 4]);
    assert_eq!(table(&streamed), "time_s,channel_1,channel_2\n0,-1,0.5\n");
    // A recorder that was cut off announces no samples, and fewer bytes than there are.
    streamed[size..size + 4].fill(0);
    assert_eq!(table(&streamed), "time_s,channel_1,channel_2\n0,-1,0.5\n");
    let whole = streamed.len() as u32 - 8;
    streamed[4..8].copy_from_slice(&whole.to_le_bytes());
    assert_eq!(table(&streamed), "time_s,channel_1,channel_2\n");
    assert!(problem(&wav(7, 1, &[0, 0])).contains("encoding 7, 8 bits"));
    assert!(problem(b"RIFF\0\0\0\0WAVE").contains("no samples"));
}

#[test]
fn json_tables_are_read_in_every_layout() {
    let rows = |row: fn(usize, f64, f64) -> String, between: &str| {
        (0..SAMPLES).map(|index| row(index, swing(index).0, swing(index).1)).collect::<Vec<_>>().join(between)
    };
    let records = rows(|_, t, a| format!("{{\"t\": {t}, \"joint\": {{\"angle\": {a}}}}}"), ",\n");
    let times = rows(|_, t, _| format!("{t}"), ",");
    let angles = rows(|_, _, a| format!("{a}"), ", ");
    let pairs = rows(|_, t, a| format!("[{t},{a}]"), ",");
    for file in [
        format!("[{records}]"),
        records.replace(",\n", "\n"),
        records.replace(",\n", "\n") + "\n{\"t\": 0.9, \"jo",
        format!("\u{feff} {{\"fs\": 64, \"log\": [{records}]}}"),
        format!("{{\"time\":[{times}],\"angle\":[{angles}],\"tags\":[\"a\"]}}"),
        format!("{{\"id\": 7, \"tags\":[\"a\"], \"data\": {{\"time\":[{times}],\"angle\":[{angles}]}}}}"),
        format!("[{pairs}]"),
        pairs.replace("],[", "]\n[") + "\n",
        format!("[[\"time\",\"angle\"],{pairs}]"),
        format!("[[{times}],[{angles}]]"),
        format!("{{\"tags\":[\"a\"],\"data\":[{pairs}]}}"),
        format!("{{\"columns\":[\"time\",\"angle\"],\"data\":[{pairs}]}}"),
        format!(
            "{{\"time\":{{{}}},\"angle\":{{{}}}}}",
            rows(|index, t, _| format!("\"{index}\":{t}"), ","),
            rows(|index, _, a| format!("\"{index}\":{a}"), ",")
        ),
        format!("{{{}}}", rows(|index, t, a| format!("\"{index}\":{{\"t\":{t},\"angle\":{a}}}"), ",")),
    ] {
        holds_the_swing(file.as_bytes());
    }
}

#[test]
fn json_cells_keep_their_kind() {
    let file = r#"[{"1": 5, "a,b": "x, \"y\"", "w": [1.5, null], "ok": true}, {"1": 18446744073709551615, "w": [NaN, -Infinity], "s": "NaN"}]"#;
    let expected = "column_1,\"a,b\",w_1,w_2,ok,s\n5,\"x, 'y'\",1.5,,1,\n18446744073709551615,,,,,NaN\n";
    assert_eq!(table(file.as_bytes()), expected);
}

#[test]
fn json_that_is_no_table_is_refused_and_other_text_left_alone() {
    for (file, expected) in [
        ("{\"name\": \"rig\", \"mass\": {\"kg\": 2}}", "only `name`, `mass`"),
        ("{\"a\": {\"t\": [1]}, \"b\": {\"t\": [1]}}", "several tables"),
        ("[{\"t\": 1}, {\"t\": ]", "damaged: expected value at line 1"),
        ("[[1, 2], {\"a\": 3}]", "neither records nor rows"),
        ("[]", "no samples"),
    ] {
        let found = problem(file.as_bytes());
        assert!(found.contains(expected), "{file}: {found}");
    }
    let strangers: String = (0..2000).map(|key| format!("{{\"k{key}\":1}}\n")).collect();
    assert!(problem(strangers.as_bytes()).contains("too few keys in common"));
    for other in
        ["[s],[deg]\n0,1\n", "[12:00:01.2] 0.5\n", "{time};{angle}\n", "t,w\n0,1\n", "", "[1", "PAR1", "<a/>"]
    {
        assert_eq!(text(other.as_bytes()), None, "{other}");
    }
}

#[test]
fn a_phyphox_experiment_holds_no_samples() {
    let found =
        problem(b"<?xml version=\"1.0\"?>\n<phyphox xmlns=\"http://phyphox.org/xml\"><title/></phyphox>");
    assert!(found.contains("holds no samples; in the app"), "{found}");
}

#[test]
fn damaged_files_of_every_kind_never_panic() {
    let json =
        format!("[{}]", "{\"t\": 0.25, \"w\": [1, {\"a\": null}]}, ".repeat(12).trim_end_matches(", "));
    let files = [
        npy(1, "[('t', '<f8'), ('s', '<U2'), ('w', '<i2', (2,))]", "False", "(2,)", &[65; 40]),
        npy(1, "'<f4'", "True", "(4, 2)", &[1; 32]),
        npz(false),
        npz(true),
        wav(1, 3, &[7; 60]),
        wav(3, 8, &[7; 64]),
        lvm("Multi", &segment("12:00:00", "1")),
        lvm("No", &[segment("12:00:00", "1"), segment("12:00:09", "2")].concat()),
        "MIN=0\t-5\nDEF=\"t\" t / s\tU_A1 / V\n0,0\t1,0\n".repeat(2).into_bytes(),
        "10:12:31.010 -> angle:4.15 target: -1\n".repeat(9).into_bytes(),
        mat(&[matrix(6, "a", [2, 3], &element(9, &[7; 48])), matrix(2, "s", [1, 1], &[8; 24])]),
        json.clone().into_bytes(),
        json.replace("}, {", "}\n{").into_bytes(),
        format!("{{\"n\": 1, \"data\": {json}}}").into_bytes(),
    ];
    let mut state = 1_u32;
    let mut draw = |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    for file in &files {
        for end in 0..file.len() {
            let _ = text(&file[..end]);
        }
        for _ in 0..1500 {
            let mut damaged = file.clone();
            for _ in 0..=draw(4) {
                let at = draw(damaged.len());
                damaged[at] = [0, 255, b'9', b'-', b'[', b'"', draw(256) as u8][draw(7)];
            }
            let _ = text(&damaged);
        }
    }
}
