"""The arm AR2: its board, and six joints whose steps are counted here."""
