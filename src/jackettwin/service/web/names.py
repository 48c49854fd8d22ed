"""What names in requests may be, as patterns and in words."""

ASSET = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"
USER = r"^[A-Za-z0-9][A-Za-z0-9._@-]{0,63}$"
RECORD = r"^[0-9a-f]{8,64}$"

ALLOWED = {
    ASSET: "1 to 64 letters a to z or A to Z, digits, _ and -, a letter or digit first",
    USER: "1 to 64 letters a to z or A to Z, digits, ., _, @ and -, a letter or digit first",
    RECORD: "8 to 64 of the characters 0 to 9 and a to f",
}
