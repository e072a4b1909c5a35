"""A motion capture system as a source: registered, decoded, reported as readings with their age."""
