<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16-Białowieża" styleCategories="Symbology|Labeling">
  <pipe-data-defined-properties>
    <Option type="Map">
      <Option value="" type="QString" name="name"/>
      <Option name="properties"/>
      <Option value="collection" type="QString" name="type"/>
    </Option>
  </pipe-data-defined-properties>
  <pipe>
    <provider>
      <resampling maxOversampling="2" enabled="false" zoomedInResamplingMethod="nearestNeighbour" zoomedOutResamplingMethod="nearestNeighbour"/>
    </provider>
    <rasterrenderer nodataColor="" type="singlebandpseudocolor" alphaBand="-1" band="1" opacity="0.85" classificationMax="0.01" classificationMin="0">
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Estimated</statAccuracy>
        <cumulativeCutLower>0.02</cumulativeCutLower>
        <cumulativeCutUpper>0.98</cumulativeCutUpper>
        <stdDevFactor>2</stdDevFactor>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader maximumValue="0.01" minimumValue="0" labelPrecision="6" colorRampType="DISCRETE" classificationMode="1" clip="0">
          <item value="1e-06" label="below 0.0001 % of this sky's light" alpha="0" color="#000000"/>
          <item value="1e-05" label="0.0001–0.001 %" alpha="255" color="#481e6f"/>
          <item value="3e-05" label="0.001–0.003 %" alpha="255" color="#3f4789"/>
          <item value="0.0001" label="0.003–0.01 %" alpha="255" color="#306a8e"/>
          <item value="0.0003" label="0.01–0.03 %" alpha="255" color="#238a8e"/>
          <item value="0.001" label="0.03–0.1 %" alpha="255" color="#24a983"/>
          <item value="0.003" label="0.1–0.3 %" alpha="255" color="#56c666"/>
          <item value="0.01" label="0.3–1 %" alpha="255" color="#a6db35"/>
          <item value="inf" label="above 1 %, by one pixel" alpha="255" color="#fde725"/>
          <rampLegendSettings prefix="" maximumLabel="" suffix="" direction="0" minimumLabel="" orientation="2" useContinuousLegend="1">
            <numericFormat id="basic">
              <Option type="Map">
                <Option value="" type="QChar" name="decimal_separator"/>
                <Option value="6" type="int" name="decimals"/>
                <Option value="0" type="int" name="rounding_type"/>
                <Option value="false" type="bool" name="show_plus"/>
                <Option value="true" type="bool" name="show_thousand_separator"/>
                <Option value="false" type="bool" name="show_trailing_zeros"/>
                <Option value="" type="QChar" name="thousand_separator"/>
              </Option>
            </numericFormat>
          </rampLegendSettings>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast gamma="1" brightness="0" contrast="0"/>
    <huesaturation colorizeBlue="128" grayscaleMode="0" invertColors="0" colorizeStrength="100" colorizeRed="255" saturation="0" colorizeGreen="128" colorizeOn="0"/>
    <rasterresampler maxOversampling="2"/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
