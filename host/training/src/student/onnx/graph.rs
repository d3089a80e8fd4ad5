//! Graph of an ONNX file, written node by node.
//!
//! Source of the fields' numbers: `onnx.proto` of the ONNX specification. A network of floats needs so few of the messages
//! that they are written here without a crate for all of them.

use super::protobuf::Message;

/// Version of the file format.
const IR_VERSION: u64 = 8;
/// Version of the operators: the first with `LayerNormalization`.
const OPERATORS: u64 = 17;

/// Type of a tensor's elements.
#[derive(Clone, Copy)]
enum Element {
    F32 = 1,
    I64 = 7,
}

/// Value of a node's attribute.
#[derive(Clone, Copy, Debug)]
pub(super) enum Attribute {
    /// One f32.
    Float(f32),
    /// One integer.
    Integer(u64),
    /// Integers.
    Integers(&'static [u64]),
}

/// Graph so far. A value is known by its name.
#[derive(Debug, Default)]
pub(super) struct Graph {
    message: Message,
    /// Number of names that were given.
    names: usize,
}

impl Graph {
    /// Adds a constant of floats, row-major.
    pub(super) fn floats(&mut self, shape: &[usize], values: &[f32]) -> String {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        self.constant(Element::F32, shape, &bytes.collect::<Vec<_>>())
    }

    /// Adds a constant of one axis: a shape, or places on an axis.
    pub(super) fn integers(&mut self, values: &[usize]) -> String {
        let bytes = values
            .iter()
            .flat_map(|&value| (value as u64).to_le_bytes());
        self.constant(Element::I64, &[values.len()], &bytes.collect::<Vec<_>>())
    }

    fn constant(&mut self, element: Element, shape: &[usize], bytes: &[u8]) -> String {
        let name = self.name();
        self.message.message(5, |tensor| {
            for &length in shape {
                tensor.integer(1, length as u64);
            }
            tensor.integer(2, element as u64);
            tensor.bytes(8, &name);
            tensor.bytes(9, bytes);
        });
        name
    }

    /// Adds a node with one output.
    pub(super) fn node(
        &mut self,
        operator: &str,
        inputs: &[&str],
        attributes: &[(&str, Attribute)],
    ) -> String {
        let output = self.name();
        self.write(operator, inputs, attributes, &[&output]);
        output
    }

    /// Adds a node that splits its first input into `count` parts along the columns.
    pub(super) fn split(&mut self, inputs: &[&str], count: usize) -> Vec<String> {
        let outputs: Vec<String> = (0..count).map(|_| self.name()).collect();
        let names: Vec<&str> = outputs.iter().map(String::as_str).collect();
        self.write("Split", inputs, &[("axis", Attribute::Integer(1))], &names);
        outputs
    }

    fn write(
        &mut self,
        operator: &str,
        inputs: &[&str],
        attributes: &[(&str, Attribute)],
        outputs: &[&str],
    ) {
        self.message.message(1, |node| {
            inputs.iter().for_each(|input| node.bytes(1, input));
            outputs.iter().for_each(|output| node.bytes(2, output));
            node.bytes(4, operator);
            for (name, value) in attributes {
                node.message(5, |attribute| {
                    attribute.bytes(1, name);
                    let kind = match value {
                        Attribute::Float(value) => {
                            attribute.float(2, *value);
                            1
                        }
                        Attribute::Integer(value) => {
                            attribute.integer(3, *value);
                            2
                        }
                        Attribute::Integers(values) => {
                            values.iter().for_each(|&value| attribute.integer(8, value));
                            7
                        }
                    };
                    attribute.integer(20, kind);
                });
            }
        });
    }

    /// Declares an input of floats.
    pub(super) fn input(&mut self, name: &str, shape: [usize; 2]) {
        self.declare(11, name, shape);
    }

    /// Gives a value of floats out under a name.
    pub(super) fn output(&mut self, name: &str, shape: [usize; 2], value: &str) {
        self.write("Identity", &[value], &[], &[name]);
        self.declare(12, name, shape);
    }

    fn declare(&mut self, field: u64, name: &str, shape: [usize; 2]) {
        self.message.message(field, |info| {
            info.bytes(1, name);
            info.message(2, |of| {
                of.message(1, |tensor| {
                    tensor.integer(1, Element::F32 as u64);
                    tensor.message(2, |dimensions| {
                        for length in shape {
                            dimensions.message(1, |one| one.integer(1, length as u64));
                        }
                    });
                });
            });
        });
    }

    fn name(&mut self) -> String {
        self.names += 1;
        format!("v{}", self.names)
    }

    /// The file, with properties for who reads it.
    pub(super) fn file(mut self, name: &str, properties: &[(&str, String)]) -> Vec<u8> {
        self.message.bytes(2, name);
        let mut file = Message::default();
        file.integer(1, IR_VERSION);
        file.bytes(2, env!("CARGO_PKG_NAME"));
        file.bytes(3, env!("CARGO_PKG_VERSION"));
        file.bytes(7, self.message.as_bytes());
        file.message(8, |operators| operators.integer(2, OPERATORS));
        for (key, value) in properties {
            file.message(14, |property| {
                property.bytes(1, key);
                property.bytes(2, value);
            });
        }
        file.as_bytes().to_vec()
    }
}
