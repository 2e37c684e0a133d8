"""What the player cannot play."""


class Unplayable(ValueError):
    """The plan names something that is missing, or a shape that the player does not know."""
