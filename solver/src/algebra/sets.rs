//! Things that belong together, found pair by pair.

/// Sets of numbers from 0 on, each named after its smallest member.
pub(crate) struct Sets {
    /// A smaller member of the set of each number, or the number itself.
    parents: Vec<u32>,
}

impl Sets {
    /// Every number below `count` on its own.
    pub fn new(count: usize) -> Sets {
        Sets { parents: (0..count as u32).collect() }
    }

    /// The smallest member of the set of `member`.
    pub fn first(&mut self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            let parent = self.parents[member as usize];
            self.parents[member as usize] = self.parents[parent as usize];
            member = parent;
        }
        member
    }

    /// Makes one set of the two that `a` and `b` are in.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
