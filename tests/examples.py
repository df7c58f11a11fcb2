"""How many examples a property draws: `ci` draws what the test asks for, `dev` a tenth, at least three.

`pytest --hypothesis-profile dev` chooses; `ci` holds where nothing is chosen.
"""

from hypothesis import settings

PROFILES = {"ci": 100, "dev": 10}
"""Of a hundred examples that a test asks for, how many are drawn."""


def register() -> None:
    """Makes the profiles known, and `ci` the one that holds."""
    for name, share in PROFILES.items():
        settings.register_profile(name, max_examples=share, deadline=None)
    settings.load_profile("ci")


def examples(n: int) -> settings:
    """The settings of a property that draws `n` examples, or its profile's share of them."""
    return settings(max_examples=max(3, n * settings.default.max_examples // 100))
