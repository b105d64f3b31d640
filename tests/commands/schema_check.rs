//! A validator for the keywords that `assets/schema.json` uses. It also collects the described keys that occurred.
//!
//! The crate `jsonschema` would enable other features of `serde_json`, `hashbrown` and `regex`: tests and program would no longer share
//! one build of the dependencies. `tests/run --peers` validates the same outputs with the PyPI package jsonschema.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

/// Errors of an instance, and pointers to the described keys that it has.
#[derive(Default)]
pub struct Checked {
    pub errors: Vec<String>,
    pub met: BTreeSet<String>,
}

pub struct Checker<'a> {
    pub schema: &'a Value,
}

impl Checker<'_> {
    /// Checks an instance, which is at `path`, against the schema at `pointer`.
    pub fn check(&self, pointer: &str, instance: &Value, path: &str) -> Checked {
        let mut checked = Checked::default();
        let schema = self.schema.pointer(pointer).and_then(Value::as_object);
        let schema = schema.unwrap_or_else(|| panic!("{pointer} is no schema"));
        for (keyword, value) in schema {
            let found = match keyword.as_str() {
                "description" => continue,
                "$ref" => {
                    let target = value.as_str().expect("text").trim_start_matches('#');
                    self.check(target, instance, path)
                }
                "anyOf" => self.any_of(pointer, value, instance, path),
                "properties" => self.properties(pointer, schema, instance, path),
                // Together with `properties`, or with any key.
                "additionalProperties" if schema.contains_key("properties") => continue,
                "additionalProperties" => {
                    self.values(&format!("{pointer}/{keyword}"), instance, path)
                }
                "items" => self.elements(&format!("{pointer}/{keyword}"), instance, path),
                _ => assertion(keyword, value, instance, path),
            };
            checked.errors.extend(found.errors);
            checked.met.extend(found.met);
        }
        checked
    }

    /// The alternative that fits, or the errors of the one with the fewest.
    fn any_of(&self, pointer: &str, all: &Value, instance: &Value, path: &str) -> Checked {
        let count = all.as_array().expect("a list").len();
        let alternatives =
            (0..count).map(|k| self.check(&format!("{pointer}/anyOf/{k}"), instance, path));
        alternatives.min_by_key(|checked| checked.errors.len()).expect("an alternative")
    }

    fn properties(
        &self,
        pointer: &str,
        schema: &Map<String, Value>,
        instance: &Value,
        path: &str,
    ) -> Checked {
        let mut checked = Checked::default();
        let described = schema["properties"].as_object().expect("an object");
        // Every key of the contract is described.
        assert_eq!(schema.get("additionalProperties"), Some(&Value::Bool(false)), "{pointer}");
        for (key, value) in instance.as_object().into_iter().flatten() {
            if described.contains_key(key) {
                let pointer = format!("{pointer}/properties/{key}");
                let found = self.check(&pointer, value, &format!("{path}.{key}"));
                checked.errors.extend(found.errors);
                checked.met.extend(found.met);
                checked.met.insert(pointer);
            } else {
                checked.errors.push(format!("{path}.{key} is not described"));
            }
        }
        checked
    }

    fn values(&self, pointer: &str, instance: &Value, path: &str) -> Checked {
        let values = instance.as_object().into_iter().flatten();
        self.each(values.map(|(key, value)| (format!("{path}.{key}"), value)), pointer)
    }

    fn elements(&self, pointer: &str, instance: &Value, path: &str) -> Checked {
        let elements = instance.as_array().into_iter().flatten().enumerate();
        self.each(elements.map(|(k, value)| (format!("{path}[{k}]"), value)), pointer)
    }

    fn each<'b>(&self, all: impl Iterator<Item = (String, &'b Value)>, pointer: &str) -> Checked {
        let mut checked = Checked::default();
        for (path, value) in all {
            let found = self.check(pointer, value, &path);
            checked.errors.extend(found.errors);
            checked.met.extend(found.met);
        }
        checked
    }
}

/// Checks a keyword without subschemas.
fn assertion(keyword: &str, value: &Value, instance: &Value, path: &str) -> Checked {
    let limit = || value.as_f64().expect("a number");
    let length = || match instance {
        Value::Array(list) => list.len() as f64,
        Value::Object(object) => object.len() as f64,
        _ => f64::NAN,
    };
    let holds = match keyword {
        "type" => match value {
            Value::Array(types) => types.iter().any(|name| is_of_type(instance, name)),
            name => is_of_type(instance, name),
        },
        "const" => instance == value,
        "enum" => value.as_array().expect("a list").contains(instance),
        "required" => {
            let keys = value.as_array().expect("a list").iter().filter_map(Value::as_str);
            let lacks = |object: &Map<String, Value>| {
                keys.filter(|key| !object.contains_key(*key)).map(str::to_owned).collect()
            };
            let missing: Vec<String> = instance.as_object().map_or_else(Vec::new, lacks);
            missing.is_empty()
        }
        "minimum" => instance.as_f64().is_none_or(|number| number >= limit()),
        "maximum" => instance.as_f64().is_none_or(|number| number <= limit()),
        "minItems" | "minProperties" => length().is_nan() || length() >= limit(),
        "maxItems" | "maxProperties" => length().is_nan() || length() <= limit(),
        _ => panic!("{path}: the keyword {keyword} is new"),
    };
    let text = instance.to_string();
    let short: String = text.chars().take(60).collect();
    let errors =
        if holds { Vec::new() } else { vec![format!("{path}: {keyword} {value}: {short}")] };
    Checked { errors, met: BTreeSet::new() }
}

fn is_of_type(instance: &Value, name: &Value) -> bool {
    match name.as_str().expect("text") {
        "null" => instance.is_null(),
        "boolean" => instance.is_boolean(),
        "string" => instance.is_string(),
        "number" => instance.is_number(),
        "integer" => instance.as_f64().is_some_and(|number| number.fract() == 0.0),
        "array" => instance.is_array(),
        "object" => instance.is_object(),
        other => panic!("the type {other} is new"),
    }
}

/// Pointers to all described keys below a schema.
pub fn described(schema: &Value, pointer: &str, into: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            for (key, value) in object {
                let below = format!("{pointer}/{key}");
                if pointer.ends_with("/properties") {
                    into.insert(below.clone());
                }
                described(value, &below, into);
            }
        }
        Value::Array(list) => {
            for (k, value) in list.iter().enumerate() {
                described(value, &format!("{pointer}/{k}"), into);
            }
        }
        _ => {}
    }
}
