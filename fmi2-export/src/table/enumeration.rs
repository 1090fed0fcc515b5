//! Enumerations: an ordinary Rust enum bound to an FMI enumeration type.

/// An FMI enumeration type: its name, description and items numbered 1..n.
#[derive(Debug)]
pub struct EnumType {
    /// Type name.
    pub name: &'static str,
    /// Description of the enumeration.
    pub description: &'static str,
    /// Items in the order of their numbers, the first is 1.
    pub items: &'static [Item],
    /// Reactions to the items where they are faults, the lowest severity first; empty for other enumerations.
    pub reactions: &'static [Reaction],
}

/// One item of an enumeration.
#[derive(Debug, Eq)]
pub struct Item {
    /// Item name.
    pub name: &'static str,
    /// Meaning of the item.
    pub description: &'static str,
    /// Instruction to the user, such as the remedy of a fault; empty where there is nothing to do.
    pub hint: &'static str,
    /// Name of the reaction to a fault; empty where there is none.
    pub reaction: &'static str,
    /// How a fault is detected; empty where the item is not a fault.
    pub detection: &'static str,
}

/// Reaction of a machine to a fault.
#[derive(Debug, PartialEq, Eq)]
pub struct Reaction {
    /// Name of the reaction.
    pub name: &'static str,
    /// Behavior of the machine in this reaction, such as its motion.
    pub description: &'static str,
    /// How the fault is acknowledged.
    pub acknowledge: &'static str,
}

impl PartialEq for Item {
    fn eq(&self, other: &Self) -> bool {
        // most comparisons are of one item with itself, whose texts need no look
        std::ptr::eq(self, other)
            || (self.name, self.description, self.hint) == (other.name, other.description, other.hint)
    }
}

/// A Rust enum with the numbers 1..n; implemented by [`interface`](macro@crate::interface).
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
