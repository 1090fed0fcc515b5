//! Enumerations: an ordinary Rust enum bound to an FMI enumeration type.

/// An FMI enumeration type: its name, description and items numbered 1..n.
#[derive(Debug)]
pub struct EnumType {
    /// Type name.
    pub name: &'static str,
    /// What the enumeration tells.
    pub description: &'static str,
    /// Items in the order of their numbers, the first is 1.
    pub items: &'static [Item],
}

/// One item of an enumeration.
#[derive(Debug)]
pub struct Item {
    /// Item name.
    pub name: &'static str,
    /// Meaning of the item.
    pub description: &'static str,
    /// What to do about it; empty where there is nothing to do.
    pub hint: &'static str,
}

/// A Rust enum with the numbers 1..n; implemented by [`enumeration!`](crate::enumeration).
pub trait Enumeration: Copy + 'static {
    /// The type in the model description.
    const TYPE: &'static EnumType;
    /// The enum value of an item number.
    fn from_number(number: i32) -> Option<Self>;
    /// The item number of the enum value.
    fn number(self) -> i32;
    /// The item of the enum value.
    fn item(self) -> &'static Item {
        &Self::TYPE.items[self.number() as usize - 1]
    }
}

/// Binds a Rust enum (with explicit discriminants 1..n) to an FMI enumeration type.
///
/// Every variant must be named, with its number and a description; a missing variant or a wrong
/// number does not compile.
///
/// ```
/// #[derive(Clone, Copy)]
/// enum Mode { Off = 1, On = 2 }
/// fmi2_export::enumeration! { Mode, "What the controller does" {
///     Off = 1, "Output held at zero",
///     On = 2, "Controls",
/// } }
/// ```
///
/// ```compile_fail
/// #[derive(Clone, Copy)]
/// enum Mode { Off = 1, On = 3 }
/// fmi2_export::enumeration! { Mode, "The second number is wrong" {
///     Off = 1, "Output held at zero",
///     On = 2, "Controls",
/// } }
/// ```
#[macro_export]
macro_rules! enumeration {
    ($type:ident, $description:literal { $($item:ident = $number:literal, $text:literal),+ $(,)? }) => {
        impl $crate::Enumeration for $type {
            const TYPE: &'static $crate::EnumType = &$crate::EnumType {
                name: stringify!($type),
                description: $description,
                items: &[$($crate::Item { name: stringify!($item), description: $text, hint: "" }),+],
            };
            fn from_number(number: i32) -> Option<Self> {
                match number {
                    $($number => Some(Self::$item),)+
                    _ => None,
                }
            }
            fn number(self) -> i32 {
                self as i32
            }
        }
        const _: () = {
            // every variant is named, and the numbers are the discriminants 1..n
            const fn _complete(value: $type) { match value { $($type::$item => (),)+ } }
            let mut next = 1;
            $(
                assert!($number == next && $type::$item as i32 == next, "items must be numbered 1, 2, 3, ... as in the Rust enum");
                next += 1;
            )+
            let _ = next;
        };
    };
}
