"""Plan many random scenes, and ask an independent replay whether what the judge says of them is true."""
