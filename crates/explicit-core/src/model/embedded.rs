//! Embedded blocks of a model, such as those of bolts.

use powerhouse_model::{HistoryField, NodalView};

use super::Model;
use super::motion::by_element;

impl Model {
    /// The values of a history variable of the embedded blocks with a label, in the order of the embedded elements.
    pub(crate) fn embedded_values(&self, label: &str, variable: &str) -> Option<Vec<f64>> {
        let name = format!("{label}/{variable}");
        let blocks = self.blocks[self.embedded.clone()].iter();
        let own = blocks.filter(|block| block.label() == label);
        let fields = own.filter_map(|block| {
            let mut fields = block.history().into_iter();
            fields.find(|field| field.name == name)
        });
        Some(by_element(fields.reduce(HistoryField::with)?).values)
    }

    /// Whether a block is one of embedded elements.
    pub(crate) fn is_embedded(&self, block: usize) -> bool {
        self.embedded.contains(&block)
    }

    /// Global numbers, labels and history variables of the embedded blocks of this rank.
    pub(crate) fn own_embedded(&self) -> Vec<(u32, String, Vec<HistoryField>)> {
        let blocks = self.embedded.clone();
        let of_block = |block: usize| {
            let number = self.ranks.block_numbers[block];
            let block = &self.blocks[block];
            (number, block.label().into(), block.history())
        };
        blocks.map(of_block).collect()
    }

    /// Sets the reference configuration of embedded blocks to the present displacement.
    pub(super) fn install(&mut self) {
        for index in self.embedded.clone() {
            let own = self.displacement_of_block(index);
            self.blocks[index].set_reference_displacement(NodalView::F64(&own));
        }
    }
}
