"""A motion capture system as the bridge hears it: registered, decoded, told as readings with their age."""
