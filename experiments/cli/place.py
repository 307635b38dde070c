"""A place given on the command line."""

from swamp_rl.errors import UserError


def place_of(origin: str | None) -> tuple[float, float] | None:
    """Latitude and longitude [degrees] of --origin, None where it is not given; UserError for no place."""
    if origin is None:
        return None
    try:
        latitude, longitude = (float(part) for part in origin.split(","))
    except ValueError:
        latitude, longitude = float("nan"), float("nan")
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
        raise UserError(f"--origin {origin}: give latitude and longitude in degrees, as in 44.3489,9.1536")
    return latitude, longitude
