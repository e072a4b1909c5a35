"""`epos2`: one drive at the command line. Other packages add commands of their own to the group."""
