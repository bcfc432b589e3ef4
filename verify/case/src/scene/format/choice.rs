//! Keys whose value is one word out of a few.

/// Declares an enum that is written as a word, with its JSON Schema; `WORDS` lists the
/// words in order. After `for` stands the type of the library with the same variants.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident for $library:ty {
        $($(#[$variant_doc:meta])* $word:literal $variant:ident),+ $(,)?
    }) => {
        choice! { $(#[$doc])* $name { $($(#[$variant_doc])* $word $variant),+ } }

        impl From<$name> for $library {
            fn from(choice: $name) -> $library {
                match choice {
                    $($name::$variant => <$library>::$variant),+
                }
            }
        }
    };
    ($(#[$doc:meta])* $name:ident {
        $($(#[$variant_doc:meta])* $word:literal $variant:ident),+ $(,)?
    }) => {
        $(#[$doc])*
        #[derive(
            Debug, Clone, Copy, PartialEq, Eq, Hash, schemars::JsonSchema, serde::Serialize,
        )]
        pub enum $name {
            $($(#[$variant_doc])* #[serde(rename = $word)] $variant),+
        }

        impl $name {
            /// Every word that can be written.
            pub(crate) const WORDS: &[&str] = &[$($word),+];
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(reader: D) -> Result<$name, D::Error> {
                let word = String::deserialize(reader)?;
                match word.as_str() {
                    $($word => Ok($name::$variant),)+
                    _ => Err(serde::de::Error::unknown_variant(&word, $name::WORDS)),
                }
            }
        }
    };
}

pub(super) use choice;
