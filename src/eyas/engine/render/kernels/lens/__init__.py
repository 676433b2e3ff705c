"""Views through lenses that bend: tables, faces, what each sample shows."""
