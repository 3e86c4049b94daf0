"""How the named fabrics drape and droop, beside what is measured of such cloth."""
