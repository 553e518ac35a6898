//! The JSON schema describes the scene files that the reader accepts.

use powerhouse::Registry;
use serde_json::Value;

fn schema() -> Value {
    Registry::default().schema().to_value()
}

/// Every key of the format is documented in the schema.
#[test]
fn every_key_is_documented() {
    fn walk(value: &Value, path: &str, bare: &mut Vec<String>) {
        if let Some(Value::Object(properties)) = value.get("properties") {
            for (key, property) in properties {
                let constant = property.get("const").is_some();
                if property.get("description").is_none() && !constant {
                    bare.push(format!("{path}.{key}"));
                }
            }
        }
        match value {
            Value::Object(fields) => fields
                .iter()
                .filter(|(key, _)| *key != "if")
                .for_each(|(key, field)| walk(field, &format!("{path}/{key}"), bare)),
            Value::Array(items) => items.iter().for_each(|item| walk(item, path, bare)),
            _ => {}
        }
    }
    let mut bare = Vec::new();
    walk(&schema(), "", &mut bare);
    assert_eq!(bare, Vec::<String>::new());
}

/// The schema contains the keys of registered laws and boundaries, with ranges.
#[test]
fn registered_types_bring_their_keys() {
    let schema = schema();
    let laws = &schema["$defs"]["Material"]["properties"]["law"]["enum"];
    let names = [
        "drucker-prager",
        "elastic",
        "hoek-brown",
        "lee-fenves",
        "mazars",
        "mohr-coulomb",
        "plastic-damage",
        "two-surface",
    ];
    assert_eq!(laws, &serde_json::json!(names));
    let choices = &schema["$defs"]["Material"]["allOf"];
    let elastic = &choices[1]["then"]["properties"];
    let damage = &choices[6]["then"]["properties"];
    assert!(damage["tension"].is_object() && damage["preset"].is_object());
    assert_eq!(elastic["poisson"]["exclusiveMaximum"], 0.5);
    for (law, key) in [(2, "strength_index"), (3, "meridian_ratio")] {
        assert!(choices[law]["then"]["properties"][key].is_object(), "{key}");
    }
    let damping = &schema["$defs"]["Damping"];
    assert!(
        damping.to_string().contains("\"reference\"") && damping.to_string().contains("\"flat\"")
    );
    assert!(schema["$defs"]["Part"]["properties"]["elastic_rim"].is_object());
    let boundaries = schema["$defs"]["BoundarySection"]["allOf"]
        .as_array()
        .unwrap();
    let spring = boundaries
        .iter()
        .find(|choice| choice["if"]["properties"]["kind"]["const"] == "viscous-spring")
        .unwrap();
    assert!(spring["then"]["properties"]["distance"].is_object());
    let kernels = &schema["$defs"]["Part"]["properties"]["kernel"]["enum"];
    assert!(
        kernels
            .as_array()
            .unwrap()
            .contains(&"hex8-one-point".into())
    );
}

/// Keys of one table are in it, whatever structure has them: those of tables within are in these, and what follows from
/// another key, or from a preset, is not required.
#[test]
fn keys_of_parameters_are_where_they_are_written() {
    fn walk(value: &Value, odd: &mut Vec<String>) {
        let keys = value.get("properties").and_then(Value::as_object);
        odd.extend(keys.into_iter().flat_map(|keys| {
            let is_odd = |key: &&String| key.contains('.') || key.contains('+');
            keys.keys().filter(is_odd).cloned().collect::<Vec<_>>()
        }));
        match value {
            Value::Object(fields) => fields.values().for_each(|field| walk(field, odd)),
            Value::Array(items) => items.iter().for_each(|item| walk(item, odd)),
            _ => {}
        }
    }
    let schema = schema();
    let mut odd = Vec::new();
    walk(&schema, &mut odd);
    assert_eq!(odd, Vec::<String>::new());
    let keys = |table: &str, law: &str| {
        let choices = schema["$defs"][table]["allOf"].as_array().unwrap();
        let is_law = |choice: &&Value| choice["if"]["properties"]["law"]["const"] == law;
        choices.iter().find(is_law).unwrap()["then"].clone()
    };
    let concrete = keys("Material", "lee-fenves");
    assert_eq!(
        concrete["properties"]["tension"]["properties"]["damage"]["default"],
        1.0
    );
    assert!(concrete["properties"]["young"].is_object() && concrete.get("required").is_none());
    let bond = keys("JointSection", "bonded-coulomb");
    assert_eq!(bond["required"], serde_json::json!(["static_friction"]));
}

/// Unknown keys are invalid in the schema as in the reader, except changed keys of a case, which the reader checks in the
/// table.
#[test]
fn every_table_is_closed() {
    let schema = schema();
    let changes = ["ByName", "BySet"];
    let tables = schema["$defs"].as_object().unwrap().iter();
    for (name, definition) in tables.filter(|(name, _)| !changes.contains(&name.as_str())) {
        let open = |table: &Value| {
            table.get("properties").is_some()
                && table.get("additionalProperties") != Some(&Value::Bool(false))
                && table.get("unevaluatedProperties") != Some(&Value::Bool(false))
        };
        assert!(!open(definition), "{name}");
        for variant in definition["oneOf"].as_array().into_iter().flatten() {
            assert!(!open(variant), "{name}: {variant}");
        }
    }
}
