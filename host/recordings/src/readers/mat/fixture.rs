//! Files as MATLAB writes them, for the tests of readers and for tests/fuzz.

use std::io::Write as _;

fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = kind.to_le_bytes().to_vec();
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A variable: its name, shape, and elements column after column, of a class and packed type.
pub fn variable(name: &str, shape: [i32; 2], class: u8, kind: u32, data: &[u8]) -> Vec<u8> {
    let mut content = element(6, &[class, 0, 0, 0, 0, 0, 0, 0]);
    let axes: Vec<u8> = shape.iter().flat_map(|axis| axis.to_le_bytes()).collect();
    content.extend(element(5, &axes));
    if name.len() <= 4 {
        // Packed into its tag, as MATLAB does.
        content.extend((1 | (name.len() as u32) << 16).to_le_bytes());
        let mut short = name.as_bytes().to_vec();
        short.resize(4, 0);
        content.extend(short);
    } else {
        content.extend(element(1, name.as_bytes()));
    }
    content.extend(element(kind, data));
    element(14, &content)
}

/// A variable of doubles.
pub fn doubles(name: &str, shape: [i32; 2], values: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    variable(name, shape, 6, 9, &data)
}

/// A compressed variable.
pub fn compressed(variable: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(variable).unwrap();
    packed(&encoder.finish().unwrap())
}

/// An element of compressed data.
pub fn packed(data: &[u8]) -> Vec<u8> {
    let mut bytes = 15_u32.to_le_bytes().to_vec();
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes
}

/// A file of variables.
pub fn file(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, Platform: PCWIN64".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(variables.concat());
    bytes
}
