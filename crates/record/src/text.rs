//! Decoding of a file's bytes as text.

use crate::error::Fault;
use std::borrow::Cow;

/// Formats that contain logs but are not text: first bytes, name of the format, and instruction for
/// extracting the columns.
const OTHERS: &[(&[u8], &str, &str)] = &[
    (
        b"PK\x03\x04",
        "a ZIP archive, as Excel's workbooks (.xlsx) are",
        "save the sheet as CSV, or in Python write\n    \
         import pandas\n    \
         pandas.read_excel('in.xlsx').to_csv('out.csv', index=False)",
    ),
    (
        b"\xd0\xcf\x11\xe0",
        "an Excel workbook (.xls)",
        "save the sheet as CSV, or in Python write\n    \
         import pandas  # with xlrd\n    \
         pandas.read_excel('in.xls').to_csv('out.csv', index=False)",
    ),
    (
        b"PAR1",
        "a Parquet file",
        "in Python, ringdown_lab.logs.read_parquet reads it, or write\n    \
         import pandas  # with pyarrow\n    \
         pandas.read_parquet('in.parquet').to_csv('out.csv', index=False)",
    ),
    (
        b"\x89HDF",
        "an HDF5 file",
        "in Python write\n    \
         import h5py, numpy; m = h5py.File('in.h5'); print(list(m))\n    \
         numpy.savetxt('out.csv', numpy.c_[numpy.ravel(m['t']), numpy.ravel(m['angle'])], delimiter=',', \
         header='time_s,angle_rad', comments='')",
    ),
    (
        b"\x89MCAP",
        "an MCAP file",
        "in Python, ringdown_lab.logs.read_mcap reads it, or, where its messages are JSON, write\n    \
         import csv, json; from mcap.reader import make_reader\n    \
         csv.writer(open('out.csv', 'w')).writerows([('time_ns', 'angle_rad'), *((m.log_time, \
         json.loads(m.data)['angle']) for _, _, m in make_reader(open('in.mcap', 'rb')).iter_messages('/angle'))])",
    ),
    (b"#ROSBAG", "a ROS bag", "from Python, ringdown_lab.logs.read_rosbag reads it"),
    (
        b"SQLite format 3",
        "an SQLite database, as a ROS 2 bag is",
        "from Python, ringdown_lab.logs.read_rosbag reads a bag",
    ),
];

/// Decodes bytes as UTF-8, as UTF-16 if they begin with its byte-order mark, else as Latin-1, which older
/// loggers and spreadsheets write. Bytes that are no text are a fault.
pub(crate) fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, Fault> {
    if let Some((_, kind, remedy)) =
        OTHERS.iter().copied().find(|(beginning, ..)| bytes.starts_with(beginning))
    {
        return Err(Fault::OtherFormat { kind, remedy });
    }
    let error = match std::str::from_utf8(bytes) {
        // A program or a dump can be valid UTF-8 by chance, but no line of text contains a NUL.
        Ok(text) => match text.find('\0') {
            Some(offset) => Fault::NotText { offset },
            None => return Ok(Cow::Borrowed(text)),
        },
        Err(error) => Fault::NotText { offset: error.valid_up_to() },
    };
    let units = |from: fn([u8; 2]) -> u16| -> Vec<u16> {
        bytes.chunks_exact(2).filter_map(|pair| Some(from(pair.try_into().ok()?))).collect()
    };
    match bytes {
        [0xff, 0xfe, ..] => String::from_utf16(&units(u16::from_le_bytes)).map(Cow::Owned).map_err(|_| error),
        [0xfe, 0xff, ..] => String::from_utf16(&units(u16::from_be_bytes)).map(Cow::Owned).map_err(|_| error),
        _ if bytes.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace()) => Err(error),
        _ => Ok(Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect())),
    }
}
