"""What is exported, as blocks: parameters, inputs, state and outputs, and three functions on them."""
