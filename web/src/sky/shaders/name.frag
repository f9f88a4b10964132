// A name that a canvas wrote.

uniform sampler2D written;
in vec2 within;
out vec4 colour;

void main() {
  colour = texture(written, within);
}
