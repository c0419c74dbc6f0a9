"""Forward stepwise selection: add, refit, select again, drop."""
