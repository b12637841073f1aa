"""Reports for people: block diagrams, curves, number texts and the page that holds them. SVG, HTML, terminal."""
