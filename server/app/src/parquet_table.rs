//! Rows of JSON as a table in Apache Parquet, for those who read skies by the thousand.

use bytes::Bytes;
use parquet::{
    basic::{Compression, LogicalType, Repetition, Type as PhysicalType},
    column::writer::ColumnWriter,
    data_type::ByteArray,
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::WriterProperties,
        writer::{SerializedColumnWriter, SerializedFileWriter},
    },
    schema::types::{Type, TypePtr},
};
use serde_json::{Map, Value};
use std::{collections::BTreeMap, sync::Arc};
use thiserror::Error;

/// The media type.
pub const MEDIA_TYPE: &str = "application/vnd.apache.parquet";

/// Why there is no table: a defect of the program.
#[derive(Debug, Error)]
pub enum ParquetTableError {
    /// The file could not be encoded.
    #[error("writing Parquet failed: {0}")]
    Parquet(#[from] ParquetError),
    /// A row is no JSON.
    #[error("a row is no JSON object: {0}")]
    Json(#[from] serde_json::Error),
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Boolean,
    Integer,
    Float,
    Text,
}

impl Kind {
    /// That of a value; None of null, which every kind has.
    fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Null => None,
            Value::Bool(_) => Some(Self::Boolean),
            Value::Number(number) if number.is_i64() => Some(Self::Integer),
            Value::Number(_) => Some(Self::Float),
            Value::String(_) | Value::Array(_) | Value::Object(_) => Some(Self::Text),
        }
    }

    /// The kind that holds both.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (one, two) if one == two => one,
            (Self::Integer | Self::Float, Self::Integer | Self::Float) => Self::Float,
            _ => Self::Text,
        }
    }

    fn column(self, name: &str) -> Result<TypePtr, ParquetError> {
        let physical = match self {
            Self::Boolean => PhysicalType::BOOLEAN,
            Self::Integer => PhysicalType::INT64,
            Self::Float => PhysicalType::DOUBLE,
            Self::Text => PhysicalType::BYTE_ARRAY,
        };
        let logical = (self == Self::Text).then_some(LogicalType::String);
        let column = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical);
        Ok(Arc::new(column.build()?))
    }
}

/// Rows whose values are columns: those of objects in objects have names with dots, and lists are JSON.
#[derive(Debug, Default)]
pub struct ParquetTable {
    rows: Vec<BTreeMap<String, Value>>,
}

impl ParquetTable {
    /// Adds a row, a JSON object.
    ///
    /// # Errors
    /// [`ParquetTableError::Json`].
    pub fn add(&mut self, json: &[u8]) -> Result<(), ParquetTableError> {
        let mut row = BTreeMap::new();
        flatten(serde_json::from_slice(json)?, "", &mut row);
        self.rows.push(row);
        Ok(())
    }

    /// The file: a column for whatever a row has, null in the other rows.
    ///
    /// * `first`: columns that come first, in their order; the others follow by name.
    /// * `notes`: keys and values of the file's metadata.
    ///
    /// # Errors
    /// [`ParquetTableError::Parquet`], only by a defect.
    pub fn encode(&self, first: &[&str], notes: &[(&str, &str)]) -> Result<Vec<u8>, ParquetTableError> {
        let mut kinds: BTreeMap<&str, Option<Kind>> = BTreeMap::new();
        for (name, value) in self.rows.iter().flatten() {
            let kind = kinds.entry(name).or_default();
            *kind = match (*kind, Kind::of(value)) {
                (Some(one), Some(two)) => Some(one.with(two)),
                (one, two) => one.or(two),
            };
        }
        // A column of nulls alone is taken for one of numbers, as most that may be null are.
        let mut columns: Vec<(&str, Kind)> =
            kinds.into_iter().map(|(name, kind)| (name, kind.unwrap_or(Kind::Float))).collect();
        let place = |name: &str| first.iter().position(|other| *other == name).unwrap_or(first.len());
        columns.sort_by_key(|(name, _)| place(name));

        let fields = columns.iter().map(|(name, kind)| kind.column(name)).collect::<Result<_, _>>()?;
        let schema = Type::group_type_builder("schema").with_fields(fields).build()?;
        let notes = notes.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), (*value).to_owned()));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("Skyglow ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(notes.collect()))
            .build();
        let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for (name, kind) in columns {
            if let Some(column) = group.next_column()? {
                self.write(name, kind, column)?;
            }
        }
        group.close()?;
        Ok(writer.into_inner()?)
    }

    fn write(
        &self,
        name: &str,
        kind: Kind,
        mut column: SerializedColumnWriter<'_>,
    ) -> Result<(), ParquetError> {
        let values: Vec<&Value> = self.rows.iter().map(|row| row.get(name).unwrap_or(&Value::Null)).collect();
        let levels: Vec<i16> = values.iter().map(|value| i16::from(!value.is_null())).collect();
        let levels = Some(levels.as_slice());
        let there = values.into_iter().filter(|value| !value.is_null());
        match column.untyped() {
            ColumnWriter::BoolColumnWriter(writer) => {
                let values: Vec<bool> = there.filter_map(Value::as_bool).collect();
                writer.write_batch(&values, levels, None)?;
            }
            ColumnWriter::Int64ColumnWriter(writer) => {
                let values: Vec<i64> = there.filter_map(Value::as_i64).collect();
                writer.write_batch(&values, levels, None)?;
            }
            ColumnWriter::DoubleColumnWriter(writer) => {
                let values: Vec<f64> = there.filter_map(Value::as_f64).collect();
                writer.write_batch(&values, levels, None)?;
            }
            ColumnWriter::ByteArrayColumnWriter(writer) => {
                let text = |value: &Value| match value {
                    Value::String(text) => ByteArray::from(Bytes::from(text.clone())),
                    other => ByteArray::from(Bytes::from(other.to_string())),
                };
                let values: Vec<ByteArray> = there.map(text).collect();
                writer.write_batch(&values, levels, None)?;
            }
            _ => return Err(ParquetError::General(format!("column {name} is not of kind {kind:?}"))),
        }
        column.close()
    }
}

/// Puts the values of an object into a row.
fn flatten(object: Map<String, Value>, before: &str, row: &mut BTreeMap<String, Value>) {
    for (key, value) in object {
        let name = format!("{before}{key}");
        match value {
            Value::Object(inner) => flatten(inner, &format!("{name}."), row),
            value => {
                row.insert(name, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::{Field, Row},
    };

    fn read(bytes: Vec<u8>) -> (Vec<Row>, SerializedFileReader<Bytes>) {
        let reader = SerializedFileReader::new(Bytes::from(bytes)).unwrap();
        let rows = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        (rows, reader)
    }

    fn field<'a>(row: &'a Row, name: &str) -> &'a Field {
        row.get_column_iter().find(|(column, _)| *column == name).unwrap().1
    }

    /// Values come back, objects with dots, lists as JSON, and what a row lacks is null.
    #[test]
    fn rows_come_back_from_a_table() {
        let mut table = ParquetTable::default();
        table
            .add(r#"{"place":0,"name":"Brè","sky":{"cd_m2":1.5e-4,"class":4},"packs":[1,2]}"#.as_bytes())
            .unwrap();
        table.add(br#"{"place":1,"sky":{"cd_m2":3,"class":null},"error":"outside","lit":true}"#).unwrap();
        let (rows, reader) = read(table.encode(&["place", "name"], &[("unit", "lx")]).unwrap());
        let names: Vec<_> = rows[0].get_column_iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["place", "name", "error", "lit", "packs", "sky.cd_m2", "sky.class"]);
        assert_eq!(field(&rows[1], "place"), &Field::Long(1));
        assert_eq!(field(&rows[0], "name"), &Field::Str("Brè".to_owned()));
        assert_eq!(field(&rows[0], "packs"), &Field::Str("[1,2]".to_owned()));
        assert_eq!(field(&rows[0], "sky.cd_m2"), &Field::Double(1.5e-4));
        assert_eq!(field(&rows[1], "sky.cd_m2"), &Field::Double(3.0));
        assert_eq!(field(&rows[0], "sky.class"), &Field::Long(4));
        assert_eq!(field(&rows[1], "lit"), &Field::Bool(true));
        for (row, name) in [(0, "error"), (0, "lit"), (1, "name"), (1, "sky.class")] {
            assert_eq!(field(&rows[row], name), &Field::Null, "{name}");
        }
        let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert_eq!((notes[0].key.as_str(), notes[0].value.as_deref()), ("unit", Some("lx")));
    }

    /// Values of several kinds are text, none of them lost.
    #[test]
    fn mixed_columns_are_text() {
        let mut table = ParquetTable::default();
        for row in [r#"{"a":1}"#, r#"{"a":"one"}"#, r#"{"a":true}"#, r#"{"a":null}"#] {
            table.add(row.as_bytes()).unwrap();
        }
        let (rows, _) = read(table.encode(&[], &[]).unwrap());
        let values: Vec<_> = rows.iter().map(|row| field(row, "a").to_string()).collect();
        assert_eq!(values, ["\"1\"", "\"one\"", "\"true\"", "null"]);
    }

    /// No row is a file too.
    #[test]
    fn a_table_may_be_empty() {
        let (rows, _) = read(ParquetTable::default().encode(&["place"], &[]).unwrap());
        assert!(rows.is_empty());
    }
}
