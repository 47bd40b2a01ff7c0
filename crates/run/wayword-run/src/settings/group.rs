//! The macro that declares a group of settings once, for flags (clap) and for keys of the settings file (serde).

/// Declares a struct of settings. Each is optional, so that a group from flags can be completed by one from a file.
macro_rules! group {
    ($(#[$of:meta])* pub struct $Group:ident { $($(#[$how:meta])* pub $key:ident: Option<$Type:ty>,)* }) => {
        $(#[$of])*
        pub struct $Group { $($(#[$how])* pub $key: Option<$Type>,)* }

        impl $Group {
            /// The values of this group, completed by those of `other`.
            pub(super) fn over(self, other: Self) -> Self {
                Self { $($key: self.$key.or(other.$key),)* }
            }

            /// The flags of the values that are given.
            #[must_use]
            pub fn given(&self) -> Vec<String> {
                let keys = [$((stringify!($key), self.$key.is_some())),*];
                keys.iter().filter(|(_, is_given)| *is_given).map(|(key, _)| format!("--{}", key.replace('_', "-"))).collect()
            }
        }
    };
}
pub(super) use group;
