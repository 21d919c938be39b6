"""The built-in constraints come with their own issue; the contract is :class:`multirep.Constraint`."""
