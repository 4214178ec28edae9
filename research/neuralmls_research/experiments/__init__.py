"""What the paper measured, as code: methods side by side on a shape, and against true poses."""
